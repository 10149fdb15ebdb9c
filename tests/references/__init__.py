"""What the aided filter is held against: other filters of its own model, and flights drawn from that."""

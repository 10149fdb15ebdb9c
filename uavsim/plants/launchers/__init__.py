"""What pushes the aircraft along the rail, one file a kind; `push` has what the rail asks of each."""

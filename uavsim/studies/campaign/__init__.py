"""Many flights of a scenario: what each of them is, who flies it, what is kept of it, and what all of them tell."""

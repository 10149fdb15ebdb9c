"""Many flights to look at: figures, tables and numbers of a campaign."""

"""Campaigns: many flights of one scenario, and what they tell."""

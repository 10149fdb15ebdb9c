"""Plots, tables and pages of flights and of studies."""

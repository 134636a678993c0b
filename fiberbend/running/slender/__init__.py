"""Runs of rods, from the case to the folder."""

"""A run from a case to its folder."""

"""A case as objects."""

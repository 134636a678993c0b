"""A mesh as arrays, and its reference elements."""

"""The effects that a case can list."""

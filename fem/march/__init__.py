"""Load stepping."""

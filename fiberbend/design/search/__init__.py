"""The search for a case, and its confirmation."""

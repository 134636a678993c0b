"""What a case says."""

"""What a run answers, in words and numbers."""

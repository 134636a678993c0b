"""What is read off states: measures, diagnosis, checkpoints."""

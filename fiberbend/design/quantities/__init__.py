"""What can be asked of an actuator, a family a file; table.py lists them."""

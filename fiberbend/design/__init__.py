"""From what an actuator is to do to its case."""

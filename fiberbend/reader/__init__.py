"""From a file to a checked case."""

"""The models that solve a case."""

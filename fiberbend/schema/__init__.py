"""Quantities with units, problems and paths of a case."""

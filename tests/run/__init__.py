"""Whole runs: from a case to its folder."""

"""Cases of uniform bending solved in this process, many of them, without a run folder."""

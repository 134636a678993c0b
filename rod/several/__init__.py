"""Several rods solved together, which touch each other."""

"""How positions follow from the unknowns."""

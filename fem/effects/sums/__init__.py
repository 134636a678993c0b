"""Part of fiberbend. Potentials that see a few sums of the fields."""

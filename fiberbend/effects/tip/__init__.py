"""Part of fiberbend. Loads on the tip."""

"""Order of elimination."""

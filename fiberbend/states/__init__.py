"""States of a run as arrays, and what is recovered from them."""

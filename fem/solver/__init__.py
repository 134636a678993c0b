"""Newton's method, bordered systems, factorisation."""

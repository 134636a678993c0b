"""Cases as rods: laws of sections and caps, masses, loads, and the path through them."""

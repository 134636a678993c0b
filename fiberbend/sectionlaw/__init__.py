"""The law of a section as a table: energy per length by stretch, curvature and pressure."""

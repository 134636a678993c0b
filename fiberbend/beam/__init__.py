"""Sections as beams at rest: flexibility with shear, by their own elements, kept with tables."""

"""Runs of section and cell over zones along the length: one march for each, chained."""

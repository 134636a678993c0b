"""Solids swept from a section, by arrays or by gmsh."""

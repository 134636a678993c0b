"""Solids extruded from a section, by arrays or by gmsh."""

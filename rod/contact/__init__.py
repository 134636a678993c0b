"""Rods that touch: rigid obstacles, points of a rod's surface, and the rod against itself."""

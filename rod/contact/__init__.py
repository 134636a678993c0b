"""Rods that touch: rigid obstacles, and points of a rod's surface."""

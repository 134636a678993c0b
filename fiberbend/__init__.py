"""Soft fiber-reinforced bending actuators."""

"""Hands: several actuators as rods, with what they grasp."""

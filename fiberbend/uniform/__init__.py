"""Scenes of uniform bending in this process: small, marched quickly, used again."""

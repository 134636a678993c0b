"""Geometrically exact rods: slender bodies by a law of their section, at rest and in motion.

Part of fiberbend.
"""

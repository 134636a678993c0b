"""Material laws as pure functions, fibers, and named materials with their source.

Part of fiberbend.
"""

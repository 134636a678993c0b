"""Closed-form models: what is known without finite elements.

Part of fiberbend.
"""

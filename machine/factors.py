"""What a factor of a tangent costs beside a solve with it."""

from __future__ import annotations

LARGE = 20_000
"""Unknowns from which a factor costs as much as twenty solves: one is to serve several steps of
Newton's method. The solver goes by it, and so does what a run is expected to take."""

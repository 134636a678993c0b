"""Neo-Hooke's law; MPa."""

from __future__ import annotations

from typing import Any

from materials.laws.law import Deformation, Law, Parameter


def energy(state: Deformation, mu: Any) -> Any:
    """W = μ/2 (I1 − 3)."""
    return mu / 2 * (state.i1 - 3)


LAW = Law("neo-hooke", energy, (Parameter("mu", "Shear modulus", allowed="above zero"),))

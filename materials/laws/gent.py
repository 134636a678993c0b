"""Gent's law: rubber whose chains end; MPa.

A. N. Gent, A new constitutive relation for rubber, Rubber Chem. Technol. 69 (1996) 59-61,
doi 10.5254/1.3538357.
"""

from __future__ import annotations

from typing import Any

from materials.laws.law import Deformation, Law, Parameter


def energy(state: Deformation, mu: Any, jm: Any) -> Any:
    """W = −μ Jm/2 ln(1 − (I1 − 3)/Jm); no number beyond the limit I1 − 3 = Jm."""
    return -mu / 2 * jm * state.ln(1 - (state.i1 - 3) / jm)


def exhausted(state: Deformation, mu: Any, jm: Any) -> Any:
    """(I1 − 3)/Jm."""
    return (state.i1 - 3) / jm


LAW = Law(
    "gent",
    energy,
    (
        Parameter("mu", "Shear modulus", allowed="above zero"),
        Parameter("jm", "Limit of I1 - 3", unit="1", allowed="above zero", elsewhere=1e30),
    ),
    exhausted,
)

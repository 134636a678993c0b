"""Ogden's law in principal stretches, up to three terms; MPa.

R. W. Ogden, Large deformation isotropic elasticity, Proc. R. Soc. Lond. A 326 (1972) 565-584,
doi 10.1098/rspa.1972.0026, in the convention of Abaqus: the shear modulus at rest is Σ μi. In
Ogden's own convention, W = Σ μ'i/αi (…), μ'i = 2 μi/αi.
"""

from __future__ import annotations

from typing import Any

from materials.laws.law import Deformation, Law, Parameter

MOST = 25.0
"""Greatest |α|: up to here power sums are good to 1e-12 over stretches from 0.3 to 4."""


def energy(
    state: Deformation,
    mu1: Any,
    alpha1: Any,
    mu2: Any = None,
    alpha2: Any = None,
    mu3: Any = None,
    alpha3: Any = None,
) -> Any:
    """W = Σ 2 μi/αi² (λ1^αi + λ2^αi + λ3^αi − 3)."""
    terms = [(mu1, alpha1), (mu2, alpha2), (mu3, alpha3)]
    return sum(
        2 * mu / alpha**2 * (state.power_sum(alpha) - 3) for mu, alpha in terms if mu is not None
    )


def _term(number: int) -> tuple[Parameter, Parameter]:
    """A term that may be left out."""
    mu = f"mu{number}"
    return (
        Parameter(mu, f"Share {number} of the shear modulus at rest", term=mu),
        Parameter(
            f"alpha{number}",
            f"Exponent {number} of the stretches",
            unit="1",
            allowed="other than zero",
            most=MOST,
            term=mu,
        ),
    )


LAW = Law(
    "ogden",
    energy,
    (
        Parameter("mu1", "Share 1 of the shear modulus at rest"),
        Parameter(
            "alpha1",
            "Exponent 1 of the stretches",
            unit="1",
            allowed="other than zero",
            most=MOST,
        ),
        *_term(2),
        *_term(3),
    ),
)

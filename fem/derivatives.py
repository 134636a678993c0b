"""Potentials and their derivatives as UFL forms, by the names under which a scene has them."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import ufl

from fem.kernels import differentiate, upper_tangent
from fem.kinematics.kinematics import Kinematics


def derivatives(
    body: Kinematics, potentials: Mapping[str, Any], outside: Collection[str]
) -> dict[str, Any]:
    """Residual, tangent, energies, forces from outside, and all that global scalars enter.

    Args:
        body: the kinematics with the unknowns.
        potentials: signed potentials as forms, by effect.
        outside: effects whose forces are told apart.
    """
    whole = sum(potentials.values(), ufl.Form([]))
    test, trial = ufl.TestFunction(body.space), ufl.TrialFunction(body.space)
    residual = ufl.derivative(whole, body.w, test)
    # frozen values, as Ogden's law has, take minutes to compile by components
    whole_tangent = ufl.derivative(residual, body.w, trial)
    tangent = whole_tangent if body.stand_ins else upper_tangent(whole, body.w)
    forms: dict[str, Any] = {"residual": residual, "tangent": tangent}
    for key, form in potentials.items():
        forms[f"energy {key}"] = form
        if key in outside:
            forms[f"force {key}"] = ufl.derivative(form, body.w, test)
    lowered = ufl.algorithms.apply_algebra_lowering.apply_algebra_lowering(whole)
    for i, name in enumerate(body.scalars):
        conjugate = differentiate(lowered, body.scalar(name))
        if conjugate is None:
            continue  # only potentials with own code have it
        forms[f"conjugate {name}"] = conjugate
        forms[f"load {name}"] = ufl.derivative(conjugate, body.w, test)
        for other in list(body.scalars)[i:] if body.natural else ():
            second = differentiate(conjugate, body.scalar(other))
            if second is not None:
                forms[f"second {name} {other}"] = second
    if body.pressure_field is not None:
        forms["volume"] = body.part(test, body.pressure_field)[0] * body.dx()
    if body.stand_ins:
        forms = {name: ufl.replace(form, body.stand_ins) for name, form in forms.items()}
    return forms

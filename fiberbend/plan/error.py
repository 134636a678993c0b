"""How far the answer of a model is expected to be off, and where that is known from.

Everything was measured on the baseline of Polygerinos et al. 2015; docs/ has the tables.
"""

from __future__ import annotations

from collections.abc import Iterator

from fiberbend.case.case import Case
from fiberbend.effects.table import (
    BlockedTipEffect,
    ContactEffect,
    GravityEffect,
    PressureEffect,
    WindingEffect,
)
from fiberbend.models.choice import choose_half
from fiberbend.models.closed_form import held
from fiberbend.models.mesh_size import cell_slice
from fiberbend.models.resolution import BULGING_PITCH, bulging, resolved

_CLOSED_FORM = "pressure for an angle 33 % (90°) to 13 % (360°) above the section model"
_SECTION = ((4, 0.03), (3, 0.06), (2, 0.13), (1, 0.3))
"""By refinement."""
_CELL = ((8, 0.2), (4, 0.4), (0, 1.9))
"""By layers a half pitch."""
_ENDS = "the whole body bends 0.6 to 1.4 % further than its middle (docs/accuracy_free.md)"


def errors_of(case: Case, model: str) -> Iterator[str]:
    """Expected errors of a run, each with its source.

    Yields:
        One line of text each.
    """
    if case.find(PressureEffect) is None:
        return
    if model == "analytic":
        yield from _closed_form(case)
        return
    if held(case):
        yield from _held(case, model)
    elif model == "body":
        yield "mesh: finer elements move P by 0.1 to 0.3 % (docs/accuracy_free.md)"
        if case.find(ContactEffect) is not None:
            yield "obstacles: yield a little: up to 0.3 % of their force (docs/contact.md)"
        elif case.find(GravityEffect) is None:
            yield f"ends: {_ENDS}: see uniform_angle_deg"
    else:
        yield f"mesh: moves P by up to {_mesh(case, model)} % (docs/accuracy_uniform.md)"
        yield f"ends: left out; {_ENDS}"
    if case.mesh.element == "tetrahedron":
        yield "tetrahedra: too stiff beside hexahedra of the same length; refine once to see it"
    yield from _winding(case, model)


def _mesh(case: Case, model: str) -> float:
    """Error in percent of the pressure for an angle up to 360°, by the mesh of section or cell."""
    if model == "section":
        return next(error for n, error in _SECTION if case.mesh.section >= n)
    if case.find(WindingEffect) is None:
        return _CELL[-1][1]
    half = choose_half(case)[0]
    layers = cell_slice(case, half)[1] / (1 if half else 2)
    return next(error for least, error in _CELL if layers >= least)


def _closed_form(case: Case) -> Iterator[str]:
    if held(case):
        yield "κP/L_f: 42 % below the section held straight on the baseline (54 to 94 N mm)"
        return
    yield f"closed form: {_CLOSED_FORM} on the baseline (docs/crosscheck.md)"
    yield "fitted to an experiment: up to 11 % in pressure (Polygerinos et al. 2015)"


def _held(case: Case, model: str) -> Iterator[str]:
    if case.find(BlockedTipEffect) is not None:
        yield "mesh: moves the tip force by 1 to 3 % (docs/accuracy_blocked.md)"
        yield "strips: other roofs and posts move it by up to 12 % (docs/accuracy_blocked.md)"
        return
    if case.find(ContactEffect) is not None:
        yield "mesh: moves the tip force by 1 to 3 % (docs/accuracy_blocked.md)"
        yield "obstacles: yield a little, which costs 0.2 % of the force (docs/contact.md)"
        return
    yield f"mesh: moves the moment by up to {_mesh(case, model)} %"
    yield "tip: a real one turns, its sheath yields: about half the force (docs/accuracy_causes.md)"


def _winding(case: Case, model: str) -> Iterator[str]:
    """The part of the bulging between the fibers that the model does not see."""
    winding, pressure = case.find(WindingEffect), case.find(PressureEffect)
    if winding is None or pressure is None or held(case):
        return
    missing = 1 - resolved(case, model)
    low, high = (missing * bulging(winding.pitch, angle) for angle in (90.0, 360.0))
    if high >= 0.05:
        scaled = "" if winding.pitch == BULGING_PITCH else f", scaled from {BULGING_PITCH:g} mm"
        yield (
            f"winding: P too low by about {low:.1f} % at 90° to {high:.1f} % at 360°: the rubber "
            f"between turns {winding.pitch:g} mm apart bulges (docs/crosscheck.md{scaled})"
        )
    elif model == "body":
        yield "winding: resolved; against a cell within 1.5 % (docs/accuracy_winding.md)"

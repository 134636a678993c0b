"""What is known to be doubtful of an answer before it is solved: plain sentences."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.zones import zone_cases
from fiberbend.effects.effect import Effect
from fiberbend.effects.wound.turns import Turns
from fiberbend.models.choice import choose_model
from fiberbend.models.ends import AT_ENDS
from fiberbend.models.model import ModelKind
from fiberbend.models.resolution import FARTHEST_PITCH, lost_pressure, winding_remark
from fiberbend.plan.memory import gigabytes, needed_mb, room
from fiberbend.schema.slips import LIMITS
from fiberbend.schema.units import show

_LOOSE = 1e-5
"""Tolerance of Newton's method from which it shows in the curves."""
_TIGHT = 0.5
"""Part of the free memory beyond which an estimate good to a factor of two may not be enough."""
_FEW_TURNS = 3.0


def doubts(case: Case) -> list[str]:
    """Every doubt that is known of a case's answer, before anything is solved."""
    model = choose_model(case)[0]
    return [*_model(case, model), *_winding(case, model), *_numbers(case)]


def errors(case: Case, model: ModelKind) -> Iterator[str]:
    """Expected errors of a run under a load of the chamber, each with its source.

    Yields:
        One line of text each.
    """
    if case.inflation is None:
        return
    if case.zones is not None:
        each = (errors(zone, model) for zone in zone_cases(case, model.name))
        lines = dict.fromkeys(itertools.chain.from_iterable(each))
        yield from (line for line in lines if not line.startswith(AT_ENDS))
        yield from model.errors_of_zones()
        return
    yield from model.errors(case)
    if case.mesh.element == "tetrahedron":
        apart = "tip force 3 to 4 % below" if case.straight else "P up to 1.3 % above"
        yield f"tetrahedra: {apart} that of hexahedra of the same length (docs/limits.md)"
    yield from lost_pressure(case, model)


def _model(case: Case, model: ModelKind) -> Iterator[str]:
    for path, text in model.leaves_out(case):
        yield f"model {model.name} leaves out {path}: {text}"
    for effect in case.acting:
        # an effect that says nothing of its errors
        if type(effect).uncertainties is Effect.uncertainties:
            yield from effect.uncertainties(case.straight)


def _winding(case: Case, model: ModelKind) -> Iterator[str]:
    if case.zones is not None:
        for place, zone in enumerate(zone_cases(case, model.name), start=1):
            yield from (f"zone {place}: {line}" for line in _winding(zone, model))
        return
    turns = case.turns
    if turns is None or model.line:
        return
    remark = winding_remark(case)
    if remark is not None and remark.startswith("NOT"):
        yield f"winding {remark}"
    number = case.actuator.length / turns.spacing
    if number and not turns.discrete and number < _FEW_TURNS:
        yield (
            f"winding: {number:.2g} turns over the chamber's length are spread over its surface, "
            "where the thread lies in truth does not enter (as: discrete, model body)"
        )
    elif (
        turns.pitch is not None
        and turns.pitch > FARTHEST_PITCH
        and model.resolved_bulging(case) < 1
    ):
        yield (
            f"winding: rubber bulges between turns {turns.pitch:g} mm apart, how much too low that "
            f"makes the pressure is not known beyond {FARTHEST_PITCH:g} mm (docs/crosscheck.md)"
        )
    yield from _thread(case, turns)


def _thread(case: Case, turns: Turns) -> Iterator[str]:
    stiff = 3 * convert.material(case.materials.wall).initial_shear_modulus
    if turns.modulus < stiff:
        meant = LIMITS["modulus"].meant(turns.modulus, "modulus")
        yield (
            f"winding: the thread's modulus, {show(turns.modulus, 'modulus')}, is below the "
            f"wall's, {stiff:.3g} MPa: it holds hardly anything{meant}"
        )


def _numbers(case: Case) -> Iterator[str]:
    if choose_model(case)[0].elements() is None:
        return
    if case.solver.linear == "iterative" and choose_model(case)[0].ends:
        yield (
            "solver.linear iterative: no stability is told, an instability may be passed unseen; "
            "only direct counts unstable modes"
        )
    if case.solver.tolerance > _LOOSE:
        yield (
            f"solver.tolerance {case.solver.tolerance:g}: forces balance to that part only, "
            "1e-8 is usual"
        )
    free, need = room(), needed_mb(case)
    if free is not None and need > _TIGHT * free.mb:
        share = f"of the {gigabytes(free.mb)} that are free"
        if need > free.mb:
            share = f"where {gigabytes(free.mb)} are free"
        yield f"memory: about {gigabytes(need)} {share}, an estimate good to a factor of two"

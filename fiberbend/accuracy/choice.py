"""The cheapest model, winding and mesh whose expected error is what a case asks for."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterator
from typing import TypeVar, cast

from fiberbend.accuracy.budget import Estimate, estimate
from fiberbend.calibration import expected
from fiberbend.calibration.calibrate import waits
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.effects.effect import Draft
from fiberbend.effects.wound.turns import Turns
from fiberbend.models.choice import MODELS, objection
from fiberbend.models.model import MeshedModel, Objection, completed_mesh
from fiberbend.schema.quantities import Spec
from fiberbend.schema.units import show

MOST_S = 3600.0
"""Seconds of a run that is chosen, by the models' own estimate."""
NEAR = 1.1
"""Where none can be promised the cheapest is taken that comes so near the least error."""
MOST_MB = 12_000.0
"""Its memory, likewise: the choice is the same on every machine."""
S = TypeVar("S", bound=Spec)

_FULL_TURN = math.radians(360)


@dataclasses.dataclass(frozen=True)
class Candidate:
    """A way to answer a case.

    Attributes:
        case: completed by its model.
        model: who answers.
        seconds: of the run, by the model's estimate.
        memory_mb: its memory, likewise.
        estimate: its error.
    """

    case: Case
    model: MeshedModel
    seconds: float
    memory_mb: float
    estimate: Estimate

    @property
    def affordable(self) -> bool:
        """Whether it is chosen without being asked for."""
        return self.seconds <= MOST_S and self.memory_mb <= MOST_MB

    def named(self) -> str:
        """Such as "cell, mesh.section 1, mesh.axial 0.375 mm"."""
        mesh = self.case.mesh
        words = [self.model.name, f"section {mesh.section}"]
        rung = self.model.rung(self.case)
        if rung is not None and (rung.axial or rung.layers):
            words.append(f"axial {mesh.axial:.4g} mm")
        turns = self.case.turns
        if turns is not None:
            words.append(f"winding {wound(turns)}")
        return ", ".join(words)


def wound(turns: Turns) -> str:
    """How a winding is represented, in words."""
    return "in turns" if turns.discrete else "calibrated" if turns.bulges else "spread"


def candidates(case: Case) -> list[Candidate]:
    """Every way to answer a case that leaves it as it is given, the cheapest first.

    Args:
        case: a checked case, its effects as they are given.
    """
    found = []
    for model in _models(case):
        for effects in itertools.product(*(effect.representations() for effect in case.effects)):
            done = tuple(effect.completed(model.offers) for effect in effects)
            named = case.model_copy(update={"model": model.name, "effects": done})
            if _hindered(case, named, model):
                continue
            for mesh in _meshes(named, model):
                found.append(_candidate(mesh, model))
    return sorted(found, key=lambda candidate: candidate.seconds)


def chosen(case: Case) -> Candidate | None:
    """The cheapest that can be promised, else the best that is affordable; None: there is none."""
    assert case.accuracy is not None
    ways = candidates(case)
    able = [way for way in ways if way.affordable]
    for way in able:
        if way.estimate.meets(case.accuracy):
            return way
    rest = able or ways
    # of a mesh of which nothing is known, the estimate is a least
    doubts = min((len(way.estimate.unknown) for way in rest), default=0)
    rest = [way for way in rest if len(way.estimate.unknown) == doubts]
    least = min((way.estimate.total for way in rest), default=0.0)
    return next((way for way in rest if way.estimate.total <= NEAR * least), None)


def cheaper(case: Case) -> list[Candidate]:
    """What was passed over for a completed case: the best of each cheaper model and winding.

    Only where the model was chosen: a given one has no rival.
    """
    assert case.accuracy is not None
    if not picked(case):
        return []
    rivals: dict[str, Candidate] = {}
    for way in candidates(case.model_copy(update={"model": "auto"})):
        if way.model.name == case.model:
            return list(rivals.values())
        best = rivals.get(way.model.name)
        if best is None or way.estimate.total < best.estimate.total:
            rivals[way.model.name] = way
    return []


def complete(case: Case) -> Case | None:
    """The case with model, winding and mesh chosen for its accuracy; None: no model supports it.

    What was given can still be told: what was chosen is not among the fields set.
    """
    way = chosen(case)
    if way is None:
        return None
    given = case.model_fields_set - ({"model"} if case.model == "auto" else set())
    effects = tuple(
        _given(effect, before.model_fields_set)
        for effect, before in zip(way.case.effects, case.effects, strict=True)
    )
    mesh = _given(way.case.mesh, case.mesh.model_fields_set)
    return _given(way.case.model_copy(update={"effects": effects, "mesh": mesh}), given)


def _given(spec: S, keys: set[str]) -> S:
    """A part of a case whose file has given some keys of it; the others were chosen."""
    return cast("S", type(spec).model_construct(set(keys), **dict(spec)))


def problems(case: Case) -> Iterator[Objection]:
    """What hinders an accuracy: nothing to be accurate about, or a model without a known error."""
    if case.accuracy is None:
        return
    given = f'"{show(case.accuracy, "accuracy")}"'
    if case.inflation is None:
        yield "accuracy", f"{given}, no effect without a pressure, expected no value"
    named = MODELS.get(case.model)
    if named is not None and named.elements() is None:
        able = [name for name, model in MODELS.items() if model.elements() is not None]
        what = "a closed form" if named.line else f"model {named.name}"
        yield (
            "accuracy",
            f"{given}, but {what} has no known error: expected model auto, "
            f"{', '.join(able[:-1])} or {able[-1]}",
        )


def picked(case: Case) -> bool:
    """Whether the model of a completed case was chosen for its accuracy."""
    return case.accuracy is not None and "model" not in case.model_fields_set


def _models(case: Case) -> Iterator[MeshedModel]:
    for name, kind in MODELS.items():
        elements = kind.elements()
        if elements is not None and case.model in ("auto", name):
            yield elements


def _hindered(given: Case, case: Case, model: MeshedModel) -> bool:
    """Whether a model cannot have it: of one that is to be chosen, in full.

    A representation that nobody has given may be one that this actuator cannot have.
    """
    names = {f"effects.{n}.{effect.name}": effect for n, effect in enumerate(case.effects)}
    moves = case.time is not None
    draft = Draft(convert.dimensions(case.actuator), case.actuator.length, names, moves)
    if any(True for path, effect in names.items() for _ in effect.problems(path, draft)):
        return True
    if given.model == "auto":
        return objection(case, model) is not None
    return next(model.refuses(case), None) is not None


def _meshes(case: Case, model: MeshedModel) -> Iterator[Case]:
    """The case with every mesh of a model's ladder; what is given stays."""
    seen = []
    for settings in list(model.ladder(case)) or [{}]:
        mesh = completed_mesh(case.mesh, **settings)
        if mesh not in seen:
            seen.append(mesh)
            yield model.completed(case.model_copy(update={"mesh": mesh}))


def _candidate(case: Case, model: MeshedModel) -> Candidate:
    size = model.size(case)
    load = case.inflation
    angle = load.angle if load is not None and load.angle is not None else _FULL_TURN
    turn = model.largest_turn(case)
    steps = 2 + len(case.output.at_angles) + len(case.output.at_pressures)
    if not case.straight:
        steps += math.ceil(abs(angle) / turn)
    seconds = model.start_seconds(size) + steps * model.step_seconds(case, size)
    seconds += expected.seconds(case) if waits(case) else 0.0
    return Candidate(case, model, seconds, model.memory_mb(size), estimate(case, model))

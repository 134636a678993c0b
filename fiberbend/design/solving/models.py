"""The models that a design is searched and confirmed in: section, cell and body, as readings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np

from fem.solver.problem import RefusedError
from fiberbend.calibration.digest import CELL, LAYERS
from fiberbend.case.case import Case
from fiberbend.case.section_beside import as_section
from fiberbend.case.zones import zone_cases
from fiberbend.design.quantities.seen import Reading, State
from fiberbend.effects.effect import Effect
from fiberbend.effects.pressure import inflate
from fiberbend.models.choice import problems
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.trial.solve import sensitivities, solve
from fiberbend.trial.wanted import Answer, Point, Wanted
from geometry.mesh.errors import MeshError

_NO_ANSWER = (MeshError, RefusedError, ArithmeticError, ValueError, np.linalg.LinAlgError)
"""What a case of a search may end with, and the search does not."""
States = Mapping[State, Sequence[Reading]]
Slopes = Mapping[str, States]
"""By the path of a field, what every reading changes by when the field does."""


class UnsolvedError(Exception):
    """A case has no such states, or they were not found; the text says why."""


class Model(Protocol):
    """Something that finds the states of a case."""

    def states(self, case: Case, wanted: Sequence[State]) -> States:
        """Readings of the states, of each zone from root to tip.

        Args:
            case: the whole case.
            wanted: the states.

        Raises:
            UnsolvedError: one of them is not there.
            CaseError: the model does not have the case.
        """

    def slopes(self, case: Case, wanted: Sequence[State], fields: Sequence[str]) -> Slopes | None:
        """Derivatives of the states by numbers of the case; None: cases beside are to be solved.

        Args:
            case: the whole case, whose states were found.
            wanted: the states.
            fields: paths of the numbers.
        """


class Section:
    """The section, its winding spread over its surface.

    Args:
        mesh: refinement of the section, as `mesh.section`.
    """

    def __init__(self, mesh: int) -> None:
        self._mesh = mesh

    def states(self, case: Case, wanted: Sequence[State]) -> States:
        """As of `Model`."""
        return _by_zones([self.case_of(zone) for zone in zone_cases(case)], wanted)

    def case_of(self, zone: Case) -> Case:
        """The section of an actuator that is alike all along."""
        effects = tuple(filter(None, map(_spread, zone.effects)))
        section = as_section(zone.model_copy(update={"effects": effects}), inflate(to=1.0))
        mesh = section.mesh.model_copy(update={"section": self._mesh})
        return section.model_copy(update={"mesh": mesh})

    def slopes(self, case: Case, wanted: Sequence[State], fields: Sequence[str]) -> Slopes | None:
        """Derivatives of the states by numbers of a case, by the tangent at each state.

        None where the section does not give them: of a case with zones, and of a field with which
        its mesh jumps or that it does not have.
        """
        if case.zones:
            return None
        inner = {path: self._inner(case, path) for path in fields}
        return _slopes(self.case_of(case), wanted, inner)

    def _inner(self, case: Case, path: str) -> str:
        """A path of the case in its section, whose load stands first."""
        parts = path.split(".")
        if parts[0] != "effects":
            return path
        kept = [i for i, e in enumerate(case.effects) if (s := _spread(e)) and s.beside()]
        place = kept.index(int(parts[1])) if int(parts[1]) in kept else -1
        return ".".join(["effects", str(1 + place), *parts[2:]])


class Cell:
    """The cell, every turn of the winding by itself."""

    def states(self, case: Case, wanted: Sequence[State]) -> States:
        """As of `Model`."""
        return _by_zones([cell_of(zone) for zone in zone_cases(case)], wanted)

    def slopes(self, case: Case, wanted: Sequence[State], fields: Sequence[str]) -> Slopes | None:
        """As of `Section`."""
        if case.zones:
            return None
        return _slopes(cell_of(case), wanted, {path: path for path in fields})


def cell_of(zone: Case) -> Case:
    """The cell of an actuator that is alike all along, as finely as a calibration solves it.

    Raises:
        CaseError: it has none.
    """
    effects = tuple(effect.in_cell() or effect for effect in zone.effects)
    mesh = zone.mesh.model_copy(update={"section": CELL, "element": "hexahedron"})
    if zone.turns is not None:
        mesh = mesh.model_copy(update={"axial": zone.turns.spacing / (2 * LAYERS)})
    update = {"effects": effects, "model": "cell", "accuracy": None, "mesh": mesh}
    cell = zone.model_copy(update=update)
    wrong = [Problem(path, text) for path, text in problems(cell)]
    if wrong:
        raise CaseError(wrong)
    return cell


def _spread(effect: Effect) -> Effect | None:
    """An effect as the section has it: turns of a winding, calibrated too, spread over the face."""
    return (effect.in_cell() or effect).beside() if effect.winds() else effect


def _by_zones(cases: Sequence[Case], wanted: Sequence[State]) -> States:
    answers = [_solved(case, wanted) for case in cases]
    return {state: tuple(found[state] for found in answers) for state in wanted}


def _slopes(case: Case, wanted: Sequence[State], inner: Mapping[str, str]) -> Slopes | None:
    """Derivatives of the states of a uniform case, by fields with their paths in it."""
    try:
        found = sensitivities(case, asked(wanted), inner.values())
    except (CaseError, *_NO_ANSWER):
        return None
    if not found.answer.converged:
        return None
    return {
        path: {state: (one,) for state, one in readings(found.by_field[own], wanted).items()}
        for path, own in inner.items()
    }


def _solved(case: Case, wanted: Sequence[State]) -> dict[State, Reading]:
    try:
        answer = solve(case, asked(wanted))
    except _NO_ANSWER as error:
        raise UnsolvedError(f"{type(error).__name__}: {error}") from None
    if not answer.converged:
        raise UnsolvedError(answer.reason)
    return readings(answer, wanted)


def asked(wanted: Sequence[State]) -> Wanted:
    """States as a trial takes them."""
    kinds: dict[str, list[float]] = {"angle": [], "pressure": [], "straight": []}
    for kind, value in wanted:
        kinds[kind].append(value)
    return Wanted(*(tuple(kinds[kind]) for kind in ("angle", "pressure", "straight")))


def readings(answer: Answer, wanted: Sequence[State]) -> dict[State, Reading]:
    """Readings of the states of an answer that has them all."""
    free = iter(answer.free)
    found: dict[State, Reading] = {}
    for kind in ("angle", "pressure"):
        for state in wanted:
            if state.kind == kind:
                found[state] = reading(next(free))
    kept = iter(answer.straight)
    for state in wanted:
        if state.kind == "straight":
            found[state] = reading(next(kept))
    return found


def reading(point: Point) -> Reading:
    """What is read of a point of a trial, or of derivatives of one."""
    return Reading(
        pressure=point.pressure,
        angle=point.angle,
        stretch=point.stretch,
        moment=point.moment,
        strain=point.strain,
        volume=point.volume,
        rest=point.volume_at_rest,
        work=point.work,
    )

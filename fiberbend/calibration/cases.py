"""The small cases that a calibration solves: cell and section, bent and kept straight."""

from __future__ import annotations

import math

from fiberbend.calibration.digest import CELL, LAYERS, SECTION, TOLERANCE
from fiberbend.calibration.reach import Reach, height
from fiberbend.case.case import Case, Mesh, Output, Solver
from fiberbend.effects.effect import Effect
from fiberbend.effects.pressure import inflate
from fiberbend.effects.straight import straight_of
from fiberbend.effects.wound.turns import Turns

PARTS = (0.125, 0.25, 0.5, 0.75, 1.0)
"""Of the greatest curvature: states that are bent."""
PRESSED = (0.3, 0.6)
"""Of the pressure there: states that are kept straight, where pressure comes without curvature.
Further on, turns 6 mm apart let the rubber between them wrinkle."""
_TURN = 0.25
"""Greatest step of the way, bent."""


def turns_of(case: Case) -> Turns:
    """The thread of a case that is calibrated."""
    turns = case.turns
    assert turns is not None
    return turns


def bent_cell(case: Case, reach: Reach, sign: float = 1.0) -> Case:
    """The cell of a case, bent by pressure.

    Args:
        case: has a winding.
        reach: how far.
        sign: of the angles: −1 where it bends up.
    """
    length = _length(case, reach)
    end = sign * reach.strain / height(case) * length
    angles = tuple(part * end for part in PARTS)
    return _small(
        case, "cell", length, (inflate(angle=end),), _asked(at_angles=angles), _TURN * end
    )


def straight_cell(case: Case, reach: Reach, pressure: float) -> Case:
    """The same kept straight at parts of a pressure, MPa."""
    return _straight(case, "cell", reach, pressure)


def bent_section(case: Case, reach: Reach, angles: tuple[float, ...]) -> Case:
    """The section at angles of its cell, rad, in their order; its winding has its numbers."""
    end, output = angles[-1], _asked(at_angles=angles)
    loads = (inflate(angle=end),)
    return _small(case, "section", _length(case, reach), loads, output, _TURN * end)


def straight_section(case: Case, reach: Reach, pressure: float) -> Case:
    """The same kept straight at parts of a pressure, MPa."""
    return _straight(case, "section", reach, pressure)


def _straight(case: Case, model: str, reach: Reach, pressure: float) -> Case:
    effects = (inflate(to=PRESSED[-1] * pressure), straight_of(()))
    asked = tuple(part * pressure for part in PRESSED)
    length, output = _length(case, reach), _asked(at_pressures=asked)
    return _small(case, model, length, effects, output, first=asked[0])


def _length(case: Case, reach: Reach) -> float:
    """Of a chamber that closes to a ring at the greatest curvature, or of a turn; mm.

    It enters nothing: pressures and moments of uniform bending depend on the curvature alone.
    """
    return max(2 * math.pi * height(case) / reach.strain, turns_of(case).spacing)


def _small(
    case: Case,
    model: str,
    length: float,
    loads: tuple[Effect, ...],
    output: Output,
    turn: float | None = None,
    first: float | None = None,
) -> Case:
    cell = model == "cell"
    kept = (effect.in_cell() if cell else effect.beside() for effect in case.effects)
    wound = tuple(e for e in kept if e is not None and e.winds())
    axial = turns_of(case).spacing / (2 * LAYERS)
    mesh = {"section": CELL, "axial": axial} if cell else {"section": SECTION}
    most = None if turn is None else abs(turn)
    solver = {"tolerance": TOLERANCE, "max_turn": most, "first_step": first}
    return case.model_copy(
        update={
            "model": model,
            "actuator": case.actuator.model_copy(update={"length": length}),
            "effects": (*loads, *wound),
            "mesh": Mesh().model_copy(update=mesh),
            "solver": Solver().model_copy(update=solver),
            "output": output,
        }
    )


def _asked(**values: tuple[float, ...]) -> Output:
    """Values at which a march stops."""
    return Output().model_copy(update=values)

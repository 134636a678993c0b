"""The error of a case as its parts: mesh, winding and ends, in percent of what is asked for."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping, Sequence

from fiberbend.accuracy.ends import ends_error, too_short
from fiberbend.accuracy.numbers import PITCH, STIFF, curvature, numbers, radius
from fiberbend.accuracy.table import (
    BEYOND,
    Curve,
    Knowledge,
    Known,
    at,
    down_to,
    knowledge,
    outside,
    reaches,
    up_to,
)
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.symmetry import stays_straight
from fiberbend.models.model import MeshedModel, Rung
from fiberbend.models.resolution import CALIBRATED

MESH, WINDING, ENDS = "mesh", "winding", "ends"
PARTS = (MESH, WINDING, ENDS)
FINE = Rung(1, 8)
"""The cell beside which a spread winding is put: by a run, and where it is calibrated."""
CALIBRATED_SECTION = 2
"""Elements through each thickness of the section that is calibrated by it, see
`fiberbend.calibration.digest`: their own error is within its numbers."""
BLOCKED = 3.0
"""Percent of the force of a blocked tip that a spread winding costs: 2.2 to 2.6 % less than four
layers a half pitch (docs/accuracy.md, docs/evidence/calibration.md)."""
BLOCKED_CALIBRATED = 2.0
"""The same of a winding whose bulges are calibrated: 1.6 % more to 1.8 % less than turns, by where
the last turn ends; pitches of 3 and 4.5 mm."""
BLOCKED_IN_TURNS = 2.0
"""The same of turns and elements of 3/8 of the radius or shorter: one layer a half pitch gives
1.9 % more than four."""
BLOCKED_IN_LAYERS = 0.8
"""The same of two layers a half pitch or more: 0.2 % from four, and those are no limit."""
BLOCKED_PITCH = 4.5 / 8
"""Greatest pitch over the radius with which a tip was blocked: where the last turn ends moves the
force by 1.3 % with 3/8 and by 2.4 % with this one (docs/evidence/calibration.md)."""
_SHORT_ENOUGH = 3 / 8
BULGES_AT_ENDS = 0.12
"""Pitches by which a body with turns seems longer than one whose winding is calibrated, which its
cell does not see: 0.05 found with a pitch of 3/8 of the radius, 0.1 with one of 3/4
(docs/evidence/calibration.md)."""
MARGIN = 1.1
"""Widening of every error of turns, by which few actuators stand for all between them: the greatest
found beyond was 4 % (docs/evidence/promise.md)."""
OTHER_LAW = 1.5
"""Widening for a rubber whose law is not in the table."""
OTHER_PATTERN = 2.0
"""The same for a winding that twists."""
_LAWS = frozenset({"yeoh", "neo-hooke"})
_EXPONENT = 1.3
"""Of the pitch in the error of a spread winding, see `fiberbend.models.resolution`."""
_END = 1e-6
"""Rounding of the table's numbers."""
_HIGHEST = math.radians(360)


@dataclasses.dataclass(frozen=True)
class Estimate:
    """The error that is expected of a case.

    Attributes:
        parts: percent of each of `PARTS`, widened, at the state where their sum is greatest.
        angle: bending angle there, rad; None where the actuator is kept straight.
        widened: by what factor what is known was widened.
        outside: why, a number or a reason each.
        unknown: why no error can be promised; empty where one can.
        sources: where each part comes from.
        tells: the parts say something of the case; else the table is of other actuators.
    """

    parts: Mapping[str, float]
    angle: float | None
    widened: float = 1.0
    outside: tuple[str, ...] = ()
    unknown: tuple[str, ...] = ()
    sources: Mapping[str, str] = dataclasses.field(default_factory=dict)
    tells: bool = True

    @property
    def total(self) -> float:
        """Sum of the parts: they may have one sign."""
        return sum(self.parts.values())

    def meets(self, asked: float) -> bool:
        """Whether an error of `asked` percent can be promised."""
        return not self.unknown and self.total <= asked

    def short(self) -> str:
        """Such as "0.62 % (mesh 0.25, winding 0.1, ends 0.27)"."""
        parts = ", ".join(f"{name} {percent(value)}" for name, value in self.parts.items())
        return f"{percent(self.total)} % ({parts})"


@dataclasses.dataclass(frozen=True)
class State:
    """A state that a case asks for.

    Attributes:
        curvature: radius times curvature.
        winding: percent of P by which a run has found its winding off the cell `FINE`, whose own
            error comes on top; None: by the table.
        factor: percent of what is asked for, for a percent of P: 1 where that is P.
    """

    curvature: float
    winding: float | None = None
    factor: float = 1.0


def percent(value: float) -> str:
    """Two digits: no estimate has more."""
    if value < 0.005:
        return "0"
    digits = max(0, 1 - math.floor(math.log10(value)))
    text = f"{value:.{digits}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def estimate(
    case: Case, model: MeshedModel, states: Sequence[State] = (), doubts: Sequence[str] = ()
) -> Estimate:
    """What is expected of the error of a completed case, by what is known of others.

    Args:
        case: has its mesh and winding.
        model: its model.
        states: of a run; by default those that the case asks for.
        doubts: why nothing can be promised, beside what is found here.
    """
    table = knowledge()
    entries = table.of_section(case.actuator.section)
    rung, unknown = model.rung(case), [*doubts, *_unknown(case, model, entries)]
    if rung is None:
        unknown.append("nothing is known of meshes of this kind (mesh.element)")
        rung = Rung(case.mesh.section)
    states = states or [State(each) for each in curvatures(case, table)]
    furthest = max(state.curvature for state in states)
    factor, reasons, beyond = _widening(case, entries, furthest, table)
    # of what does not bend, and of families of threads, the table has nothing
    known = (case.straight or not stays_straight(case)) and not beyond
    tells = known and not (case.turns and case.turns.pitch is None)
    unknown += beyond
    worst: Estimate | None = None
    for state in states:
        here = state.curvature
        mesh = mesh_error(case, rung, here)
        if mesh is None:
            mesh = mesh_error(case, _finest(rung), here) or 0.0
            unknown.append("nothing is known of meshes as coarse as this, bent as far")
        if case.straight and model.ends:
            mesh = max(mesh, _blocked(case, rung))
        if state.winding is None:
            winding = factor * winding_error(case, here)
        else:
            winding = state.winding + factor * lacking(case, here)
        if model.ends and case.turns is not None and case.turns.bulges:
            winding += factor * 100 * BULGES_AT_ENDS * case.turns.spacing / case.actuator.length
        parts = {
            MESH: factor * mesh,
            WINDING: winding,
            ENDS: 0.0 if model.ends or case.straight else factor * ends_error(case, here),
        }
        parts = {name: state.factor * value for name, value in parts.items()}
        angle = None if case.straight else here * case.actuator.length / radius(case)
        why = tuple(dict.fromkeys(unknown))
        found = Estimate(parts, angle, factor, reasons, why, _sources(case, state), tells)
        if worst is None or found.total > worst.total:
            worst = found
    assert worst is not None
    return worst


def _sources(case: Case, state: State) -> dict[str, str]:
    """Where each part is from."""
    origin = knowledge().origin
    table = f"{origin['command']} (commit {str(origin['commit'])[:12]})"
    turns, winding = case.turns, table
    if turns is None or turns.discrete:
        winding = "every turn"
    elif state.winding is not None:
        beside = "section and cell of this actuator"
        winding = f"{beside}, {'calibrated' if turns.bulges else 'at its own angles'}"
    return {MESH: table, WINDING: winding, ENDS: table}


def curvatures(case: Case, table: Knowledge) -> list[float]:
    """Radius times curvature at what the case asks for.

    Of a pressure, at the end or on the way, the angle is not known before the run: all angles count
    up to 360°, or to where the run ends early.
    """
    if case.straight:
        return [table.curvatures[0]]
    load, output = case.inflation, case.output
    ends = [load.angle if load is not None else None, output.stop_at_angle]
    given = [abs(angle) for angle in (*output.at_angles, *ends) if angle is not None]
    states = [curvature(case, angle) for angle in given]
    unknown = load is None or (load.angle is None and output.stop_at_angle is None)
    if unknown or output.at_pressures:
        last = max(states, default=0.0)
        if unknown:
            last = max(last, curvature(case, _HIGHEST))
        states += [*(known for known in table.curvatures if known < last), last]
    return sorted(set(states))


def mesh_error(case: Case, rung: Rung, state: float) -> float | None:
    """Percent of P at a curvature, as of the worst actuator of the shape; None: not known.

    Of spread windings only actuators count whose floor is no softer than the next one below the
    case's, of turns those whose pitch is no greater than the next one to it.
    """
    table = knowledge()
    entries = table.of_section(case.actuator.section)
    if not rung.layers:
        base = CALIBRATED_SECTION if case.turns is not None and case.turns.bulges else None
        like = down_to(entries, STIFF, numbers(case)[STIFF])
        found = _worst((known.spread for known in like), rung.section, base, table, state)
        if found is None or not rung.axial:
            return found
        part = rung.axial / radius(case)
        known = [length for length in table.spread_body if length >= part * (1 - _END)]
        if not known:
            return None
        # bodies were not bent as far as sections: beyond, what long elements cost goes on growing
        further = max(1.0, state / table.body_curvatures[-1])
        return found + further * abs(
            at(table.body_curvatures, table.spread_body[min(known)], state)
        )
    pitch = numbers(case).get(PITCH, 0.0)
    near = up_to([known for known in entries if known.turns], PITCH, pitch)
    values = [_of_turns(known, rung, table, state) for known in near]
    if not values or None in values:
        return None
    worst = max(value for value in values if value is not None)
    if not rung.axial:
        return worst
    fewer = [layers for layers in table.turns_body if layers <= rung.layers * (1 + _END)]
    return worst + table.turns_body[max(fewer)] if fewer else None


def _of_turns(known: Known, rung: Rung, table: Knowledge, state: float) -> float | None:
    """Error of the best rung of a cell that is nowhere finer, with what its finest rung may lack.

    Signs change along the curve: the greater of the two known curvatures beside the state counts.
    None where the actuator was not bent as far.
    """
    if not reaches(table.curvatures, known.turns[max(known.turns)], state):
        return None
    coarser = [
        _beside(table.curvatures, values, state)
        for (section, layers), values in known.turns.items()
        if section <= rung.section
        and layers <= rung.layers * (1 + _END)
        and not any(
            (section, layers) != (n, k)
            and section <= n <= rung.section
            and layers <= k <= rung.layers * (1 + _END)
            for n, k in known.turns
        )
    ]
    if not coarser:
        return None
    # the reference has twice the layers: a third of their error is left in it, of order two
    rest = abs(at(table.curvatures, known.turns[max(known.turns)], state)) / 3
    return MARGIN * (min(coarser) + rest)


def _blocked(case: Case, rung: Rung) -> float:
    """Percent of the force of a blocked tip, whatever the angles' ladder says of the mesh."""
    turns = case.turns
    if turns is not None and turns.bulges:
        return BLOCKED_CALIBRATED
    fine = case.mesh.axial <= _SHORT_ENOUGH * radius(case) * (1 + _END)
    if turns is None or not turns.discrete or not fine:
        return BLOCKED
    return BLOCKED_IN_LAYERS if rung.layers >= 2 * (1 - _END) else BLOCKED_IN_TURNS


def _beside(curvatures: Curve, values: Curve, state: float) -> float:
    """The greatest size of a curve at the known curvatures on both sides of one."""
    last = len(values) - 1
    above = next((n for n in range(last + 1) if curvatures[n] >= state), last)
    return max(abs(values[above]), abs(values[max(above - 1, 0)]))


def _worst(
    ladders: Iterator[Mapping[int, tuple[float, ...]]],
    section: int,
    base: int | None,
    table: Knowledge,
    state: float,
) -> float | None:
    """The greatest error of sections; beside that of a refinement whose error does not count."""
    found = []
    for ladder in ladders:
        known = [n for n in ladder if n <= section]
        if not known:
            return None
        error = at(table.curvatures, ladder[max(known)], state)
        found.append(abs(error - (at(table.curvatures, ladder[base], state) if base else 0.0)))
    return max(found)


def _finest(rung: Rung) -> Rung:
    """Stands for a mesh of which nothing is known: what is given is then no more than a least."""
    return dataclasses.replace(rung, section=16, layers=0.0 if not rung.layers else 64.0, axial=0.0)


def winding_error(case: Case, state: float) -> float:
    """Percent of P by which a spread winding is off: of the nearest actuator, by its pitch.

    The run computes it: see `fiberbend.accuracy.computed`.
    """
    turns = case.turns
    if turns is None or turns.discrete or math.isinf(turns.spacing):
        return 0.0
    if turns.bulges:
        return CALIBRATED + lacking(case, state)
    table, here = knowledge(), numbers(case)
    entries = [k for k in table.of_section(case.actuator.section) if k.winding]
    entries = entries or [known for known in table.actuators if known.winding]
    nearest = min(entries, key=lambda known: _distance(known.numbers, here))
    scale = (here[PITCH] / nearest.numbers[PITCH]) ** _EXPONENT
    return scale * abs(at(table.curvatures, nearest.winding, state))


def _distance(one: Mapping[str, float], other: Mapping[str, float]) -> float:
    """Of two actuators, by the logarithms of their numbers; the thread's last."""
    pairs = [(one[key], other[key]) for key in ("wall", "pitch", "floor", "height")]
    return sum(math.log(max(a, 1e-3) / max(b, 1e-3)) ** 2 for a, b in pairs)


def lacking(case: Case, state: float) -> float:
    """Percent of P by which the cell is off beside which a spread winding is put."""
    return mesh_error(case, FINE, state) or 0.0


def _widening(
    case: Case, entries: Sequence[Known], furthest: float, table: Knowledge
) -> tuple[float, tuple[str, ...], list[str]]:
    """Factor, reasons, and why nothing is known at all."""
    here, factor, reasons, beyond = numbers(case), 1.0, [], []
    found = list(outside(entries, here, case.turns is not None and case.turns.discrete))
    most = table.curvatures[-1]
    if not case.straight and furthest > most * (1 + _END):
        text = f"radius times curvature {furthest:.3g} (known: up to {most:.3g})"
        found.append((text, furthest / most))
    found += too_short(case)
    for text, times in found:
        reasons.append(text)
        if times > BEYOND:
            beyond.append(f"more than twice outside of what is known: {text}")
        factor *= min(times, BEYOND) ** 2
    laws = {convert.material(spec).law for _, spec in case.materials if spec is not None}
    if other := sorted(laws - _LAWS):
        reasons.append(f"law {', '.join(other)} (known: {', '.join(sorted(_LAWS))})")
        factor *= OTHER_LAW
    if case.turns is not None and case.turns.twists:
        reasons.append("a winding with a hand (known: double helix)")
        factor *= OTHER_PATTERN
    return factor, tuple(reasons), beyond


def _unknown(case: Case, model: MeshedModel, entries: Sequence[Known]) -> Iterator[str]:
    """Why no error can be promised, whatever the mesh."""
    if all(known.section != case.actuator.section for known in entries):
        yield f"nothing is known of the section {case.actuator.section}"
    for effect in case.effects:
        if effect.unmeasured():
            yield f"{effect.unmeasured()}: what that does to the error is not known"
    if case.turns is None:
        yield "nothing is known of actuators without a winding"
    elif case.turns.pitch is None:
        few = "three cells of families were 0.2, 1.5 and 2 % off finer ones"
        yield f"{few} (docs/evidence/families.md), which are too few to promise by"
    load = case.inflation
    if load is None:
        yield "nothing inflates it"
        return
    if (load.to or 0.0) < 0 or (load.angle or 0.0) < 0:
        yield "nothing is known of a vacuum, and of bending the other way"
    if case.straight and model.ends:
        yield "strips of other widths move the force by up to 12 % (docs/evidence/blocked.md)"
        if case.turns is not None and numbers(case).get(PITCH, 0.0) > BLOCKED_PITCH * (1 + _END):
            yield f"no tip was blocked with a pitch beyond {BLOCKED_PITCH:.3g} radii"

"""What caps make of the chamber's ends: a pressure turns them beside the uniform bend.

A cap holds the section beside it in its shape, and the pressure on its inner face is carried around
it by the wall. Cap and wall turn by that, without any force or moment of the actuator; the turn
fades within a width of the section. No law of a section knows it. A short body of the same section
does: what it turns beyond the uniform bend, of cap and of chamber each, is that of any length.

The clamp holds the root cap's outer face in its shape too, and a cap is no longer than it is wide:
it turns less by a moment than a beam of its section. The short body says that as well, by a small
one.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from fem.results.centre_line import CentreLine, face_axes, turn_of
from fiberbend.case import convert
from fiberbend.case.case import Case, Output, Solver
from fiberbend.case.section_beside import as_section
from fiberbend.effects.pressure import inflate
from fiberbend.effects.tip.load import turned
from fiberbend.process.kept import Kept
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sectionlaw.range import loads_of
from fiberbend.sectionlaw.store import digest_of
from fiberbend.trial.solve import solve
from fiberbend.trial.wanted import Point, Wanted
from fiberbend.uniform.small import Small
from rod.functions import Floats
from rod.law import Law
from rod.layout import Layout
from rod.offset import Offset

PARTS = ("root cap", "root end", "tip end", "tip cap")
"""Pieces that have turns of their own, from the root on; the two between lie in the chamber."""
_STRAINS = ("stretch", "curvature", "side_curvature", "twist")
STATES = 4
"""Pressures, of equal distances, through which and zero the turns are polynomials."""
_LENGTH, _ZONE, _AXIAL = 4.0, 1.5, 0.4
"""Of the short chamber, of an end and of the elements, in half widths of the winding's outline:
the ends of a chamber of four are those of one of twelve within 2 %."""

_SMALL = 2e-3
"""A moment, in parts of a shear modulus and the cube of a half width: strains of a thousandth."""


@dataclasses.dataclass(frozen=True)
class Ends:
    """What each part is longer and turns further than its forces make it.

    Attributes:
        zone: length of the chamber's parts at rest, mm.
        coefficients: by part, power of P in MPa from the first on, and what: length in mm, turns
            about the section's own x, y and about the line in rad, (4, d, 4).
        flexibility: turn of root cap and root end beyond the uniform bend by a moment about x,
            without pressure, rad/(N mm).
    """

    zone: float
    coefficients: Floats
    flexibility: float

    def to_tip(self, other: Ends) -> Ends:
        """Its own root, and the tip of another: of zones the first and the last."""
        half = len(PARTS) // 2
        coefficients = np.concatenate([self.coefficients[:half], other.coefficients[half:]])
        return dataclasses.replace(self, coefficients=coefficients)

    def added(self, part: str, pressure: float) -> Floats:
        """Length in mm and three turns in rad of a part, (4,)."""
        powers = pressure ** (1.0 + np.arange(self.coefficients.shape[1]))
        out: Floats = powers @ self.coefficients[PARTS.index(part)]
        return out

    def offset(self, law: Law, layout: Layout, chamber: slice) -> Offset:
        """The law of a rod with what its ends have beside the forces, spread evenly over each part.

        Args:
            law: of the forces, of all pieces.
            layout: of the rod; what strains that are not free would have is left out.
            chamber: its pieces between the caps.
        """
        lengths, (pieces, count) = layout.lengths, layout.shape
        reach = np.cumsum(lengths[chamber])
        near = int(np.argmin(np.abs(reach - self.zone))) + 1
        near = max(1, min(near, len(reach) // 2))
        borders = (0, chamber.start, chamber.start + near, chamber.stop - near, chamber.stop)
        parts = [slice(*borders[:2]), slice(*borders[1:3]), slice(*borders[3:])]
        parts.append(slice(chamber.stop, pieces))
        columns = [_STRAINS.index(name) if name in _STRAINS else -1 for name in layout.strains]
        added = np.zeros((self.coefficients.shape[1], pieces, count))
        for part, coefficients in zip(parts, self.coefficients, strict=True):
            for place, column in enumerate(columns):
                if column >= 0:
                    each = coefficients[:, column] / lengths[part].sum()
                    added[:, part, place] = each[:, None]
        return Offset(law, added)

    def packed(self) -> bytes:
        """As a JSON file."""
        content = dataclasses.asdict(self) | {"coefficients": self.coefficients.tolist()}
        return json.dumps(content).encode()


def unpacked(content: bytes) -> Ends:
    """Ends from a JSON file.

    Raises:
        ValueError: it holds none.
    """
    try:
        known = json.loads(content)
        coefficients = np.array(known["coefficients"], dtype=float)
        ends = Ends(float(known["zone"]), coefficients, float(known["flexibility"]))
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"no ends: {error}") from None
    numbers = np.append(coefficients, [ends.zone, ends.flexibility])
    if coefficients.shape != (len(PARTS), STATES, 4) or not np.isfinite(numbers).all():
        raise ValueError(f"no ends: coefficients of the shape {coefficients.shape}")
    return ends


def kept(path: Path | None = None) -> Kept:
    """Ends that were made before, in the user's own cache or in another folder."""
    return Kept("ends", "ends of chambers", ".json", path)


def ends_of(case: Case, farthest: float, store: Kept | None = None) -> Ends:
    """The ends of an actuator by a short body of it, from the store or anew.

    Args:
        case: a checked case without zones, of one section between two caps.
        farthest: pressure up to which, MPa; below zero for a vacuum.
        store: where they are kept; that of the user unless given.

    Raises:
        CaseError: no section stands beside the case, or the short body does not come to the
            pressure.
    """
    section, body = _short(case, farthest)
    store = kept() if store is None else store
    digest = digest_of(section, PARTS, farthest, None, loads_of(section))
    with store.alone(digest):
        known = store.read(digest, unpacked)
        if known is None:
            known = _solved(case, section, body, farthest)
            store.write(digest, known.packed())
    return known


def _solved(case: Case, section: Case, body: Case, farthest: float) -> Ends:
    pressures = tuple(farthest * (number + 1) / STATES for number in range(STATES))
    uniform = solve(section, Wanted(pressures=pressures))
    if not uniform.converged:
        raise CaseError([Problem("effects.pressure", f"no such free state: {uniform.reason}")])
    found = np.array(list(_turns(body, pressures, uniform.free)))
    if len(found) < STATES:
        text = f"the ends of a short body were found at {len(found)} of {STATES} pressures"
        raise CaseError([Problem("effects.pressure", f"{text}, expected a smaller one")])
    powers = np.array(pressures)[:, None] ** (1.0 + np.arange(STATES))
    coefficients = np.linalg.solve(powers, found.reshape(STATES, -1))
    zone = min(_ZONE * _half_width(case), case.actuator.length / 2)
    parts = coefficients.reshape(STATES, len(PARTS), 4).transpose(1, 0, 2)
    return Ends(zone, parts, _flexibility(case, body))


def _half_width(case: Case) -> float:
    return convert.dimensions(case.actuator).outline_half_width


def _short(case: Case, farthest: float) -> tuple[Case, Case]:
    """Section and body of a short chamber, the winding spread."""
    half_width = _half_width(case)
    actuator = case.actuator.model_copy(update={"length": _LENGTH * half_width})
    mesh = case.mesh.model_copy(
        update={"section": 1, "axial": _AXIAL * half_width, "element": "hexahedron"}
    )
    beside = as_section(case, inflate(to=farthest))
    section = beside.model_copy(update={"actuator": actuator, "mesh": mesh})
    pressures = tuple(farthest * (number + 1) / STATES for number in range(STATES))
    output = Output(pictures=False, fields=False).model_copy(update={"at_pressures": pressures})
    return section, section.model_copy(
        update={"model": "body", "solver": Solver(), "output": output}
    )


def _turns(
    case: Case, pressures: tuple[float, ...], uniform: tuple[Point, ...]
) -> Iterator[Floats]:
    """Length and turns of each part beyond the uniform bend, (4, 4), at each pressure found."""
    short = Small(case)
    states, _ = short.march()
    body, length = short.scene.body, case.actuator.length
    line = CentreLine(body)
    for state, point in zip(states, uniform, strict=False):
        short.put(state)
        root, tip = line.end_axes()
        half = np.array([point.angle, point.side_angle, point.twist]) / 2
        to_middle, to_end = line.turns_to(np.array([length / 2, length]))
        out = np.zeros((len(PARTS), 4))
        out[0, 1:] = turn_of(np.eye(3), root)
        out[1, 1:] = to_middle - half
        out[2, 1:] = to_end - to_middle - half
        out[3, 1:] = turn_of(tip, face_axes(body, "tip"))
        out[1:3, 0] = (line.stretch() - point.stretch) * length / 2
        yield out


def _flexibility(case: Case, short: Case) -> float:
    """Turn of the root beyond the uniform bend by a small moment, rad/(N mm)."""
    wall = convert.site(case).materials["wall"]
    moment = _SMALL * wall.initial_shear_modulus * _half_width(case) ** 3
    # a state is asked for by its pressure: next to none
    pressure = _SMALL**2 * wall.initial_shear_modulus
    load, *others = short.effects
    assert load.inflation() is not None
    output = short.output.model_copy(update={"at_pressures": (pressure,)})
    effects = (turned(moment), inflate(to=pressure), *others)
    bent = Small(short.model_copy(update={"effects": effects, "output": output}))
    states, report = bent.march()
    if not states:
        text = f"the root of a short body was not found under a moment: {report.reason}"
        raise CaseError([Problem("actuator.cap", text)])
    bent.put(states[0])
    line, length = CentreLine(bent.scene.body), short.actuator.length
    (to_middle,) = line.turns_to(np.array([length / 2]))[:, 0]
    turn = turn_of(np.eye(3), line.end_axes()[0])[0] + to_middle - line.middle()[0] / 2
    return float(turn) / moment

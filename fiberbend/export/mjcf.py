"""The rod as a chain of bodies for MuJoCo: joints with springs, an actuator for the pressure."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any

import numpy as np

from fiberbend.export.ends import ADDED, KEYS
from rod.functions import Floats

PIECES, CAP_PIECES = 40, 3
TIME_STEP = 1e-3
"""Of the file, s."""
RESOLVED = 0.5
"""Greatest product of time step and frequency of a joint alone; armatures make it so."""
DAMPING_TIME = 0.02
"""Damping over stiffness of every joint, s: an assumption where the case says nothing of it."""
JOINTS = ("stretch", "curvature", "side", "twist")
_AXES = {"stretch": "0 0 1", "curvature": "1 0 0", "side": "0 1 0", "twist": "0 0 1"}
_ORDER = (("stretch", "curvature", "side", "twist"), ("stretch", "twist", "side", "curvature"))
_MM = 1e-3


@dataclasses.dataclass(frozen=True)
class Line:
    """What the actuator makes of the pressure: rest strains that are linear in it.

    Attributes:
        stiffness: against stretch, curvature, side curvature and twist, (4,), N and N m².
        slope: of the rest strains by the pressure, (4,), 1/kPa and rad/m/kPa.
        rest_off: greatest difference of rest strains from those of the file, in parts of the
            greatest, (4,).
        stiffness_off: likewise of the stiffness, in parts of its own, (4,).
    """

    stiffness: Floats
    slope: Floats
    rest_off: Floats
    stiffness_off: Floats


def line_of(record: dict[str, Any]) -> Line:
    """The best line through rest strains from a rod without pressure, and the mean stiffness."""
    axis = record["axis"]
    pressure = np.array(record["section"]["pressure_kPa"])
    rest = rest_of(axis)
    slope = pressure @ rest / (pressure @ pressure)
    greatest = np.abs(rest).max(axis=0)
    off = np.abs(rest - pressure[:, None] * slope).max(axis=0)
    stiffness = stiffness_of(axis)
    mean = stiffness.mean(axis=0)
    return Line(
        stiffness=mean,
        slope=slope,
        rest_off=np.divide(off, greatest, out=np.zeros(4), where=greatest > 0),
        stiffness_off=np.abs(mean / stiffness - 1).max(axis=0),
    )


def damping_time(record: dict[str, Any]) -> float:
    """Of its case's motion, or what is assumed, s."""
    known = record["damping"]
    return DAMPING_TIME if known is None else float(known["retardation_time_s"])


def rest_of(axis: dict[str, Any]) -> Floats:
    """Stretch less one, and curvatures in rad/m, without load, (n, 4)."""
    bent = [axis[f"rest_{name}_1_per_mm"] for name in ("curvature", "side_curvature", "twist")]
    return np.column_stack([np.array(axis["rest_stretch"]) - 1, np.array(bent).T / _MM])


def stiffness_of(part: dict[str, Any]) -> Floats:
    """Stiffness of each joint's strain by itself, the others free, (n, 4) or (4,), N and N m²."""
    compliance = np.linalg.inv(np.array(part["bending_stiffness_N_mm2"]))
    bending = _MM**2 / np.diagonal(compliance, axis1=-2, axis2=-1)
    axial = np.array(part["axial_stiffness_N"])[..., None]
    return np.concatenate([axial, bending], axis=-1)


def turns_of(record: dict[str, Any]) -> Floats:
    """By which all ends bend together, (n,), rad."""
    out: Floats = np.sum([record["ends"][key]["turn_rad"] for key in KEYS], axis=0)
    return out


def ends_off(record: dict[str, Any]) -> float:
    """Greatest difference of that to what is linear in the pressure, in parts of the greatest."""
    pressure, turns = np.array(record["section"]["pressure_kPa"]), turns_of(record)
    line = pressure * (pressure @ turns) / (pressure @ pressure)
    most = float(np.abs(turns).max())
    return float(np.abs(turns - line).max()) / most if most else 0.0


def text(record: dict[str, Any]) -> str:
    """The file, by what rod.json says; without gravity."""
    return "\n".join(_lines(record)) + "\n"


def _lines(record: dict[str, Any]) -> Iterator[str]:
    line, pieces = line_of(record), _pieces(record)
    pressures = np.array(record["section"]["pressure_kPa"])
    most, time = float(pressures[-1]), damping_time(record)
    known = "of the motion's case" if record["damping"] else "assumed"
    off, stiff = (100 * part for part in (line.rest_off, line.stiffness_off))
    ends = 100 * ends_off(record)
    yield f'<mujoco model="{_safe(record["title"]) or "actuator"}">'
    yield f"""  <!-- Written by fiberbend from rod.json. m, kg, N; x lateral, y from floor to crown,
       z along. The control 'pressure' is in kPa, 0 to {most:.6g}. Rest strains are linear in it
       and the stiffness is constant: beside rod.json the curvature without load is off by up to
       {off[1]:.2g} % of the greatest, that of the ends by {ends:.2g} %,
       bending stiffness by {stiff[1]:.2g} %, that against stretch by {stiff[0]:.2g} %.
       rod_mujoco.py follows rod.json's table instead.
       Damping is {known}: {time:g} s times the stiffness. Armatures keep the time step of
       {TIME_STEP:g} s stable; they slow motions down that are much faster than bending. -->"""
    yield '  <compiler autolimits="true" angle="radian"/>'
    yield f'  <option timestep="{TIME_STEP:g}" integrator="implicitfast" gravity="0 0 0"/>'
    yield "  <worldbody>"
    bottom = -record["geometry"]["cap_length_mm"] * _MM
    yield f'    <body name="root" pos="0 0 {bottom:.10g}">'
    yield from _body(record, pieces, line)
    yield "    </body>"
    yield "  </worldbody>"
    yield "  <tendon>"
    yield '    <fixed name="pressure">'
    for piece in pieces:
        for name, force in zip(JOINTS, piece.forces(line, pressures), strict=True):
            if force:
                yield f'      <joint joint="{name}_{piece.name}" coef="{force:.10g}"/>'
    yield "    </fixed>"
    yield "  </tendon>"
    yield "  <actuator>"
    yield (
        f'    <general name="pressure" tendon="pressure" gainprm="1" ctrlrange="0 {most:.10g}"/>'
    )
    yield "  </actuator>"
    yield "  <sensor>"
    yield '    <framepos name="tip" objtype="site" objname="tip"/>'
    yield "  </sensor>"
    yield "</mujoco>"


@dataclasses.dataclass(frozen=True)
class _Piece:
    """A length of rod that bends in its middle.

    Attributes:
        name: of its body; joints have the names of their strains before it.
        chamber: it has a chamber.
        length: at rest, m.
        place: x, y of its axis from the centroids, m.
        stiffness: of its section, (4,).
        added: what each joint is longer and turns further by the pressure at an end, at the
            pressures of the file, (n, 4), m and rad.
        mass: its mass per length and so on, as rod.json has it.
    """

    name: str
    chamber: bool
    length: float
    place: tuple[float, float]
    stiffness: Floats
    added: Floats
    mass: dict[str, Any]

    def forces(self, line: Line, pressures: Floats) -> Floats:
        """Of its joints by the pressure, (4,), N and N m a kPa: by the best lines through rest."""
        rest = pressures @ self.added / (pressures @ pressures)
        if self.chamber:
            rest = rest + self.length * line.slope
        out: Floats = self.stiffness / self.length * rest
        return out


def _pieces(record: dict[str, Any]) -> list[_Piece]:
    """From the root to the tip."""
    geometry, line = record["geometry"], line_of(record)
    axis, cap, mass = record["axis"], record["cap"], record["mass"]
    beside = {
        "chamber": False,
        "length": geometry["cap_length_mm"] * _MM / CAP_PIECES,
        "place": (cap["x_mm"] * _MM, cap["y_mm"] * _MM),
        "stiffness": stiffness_of(cap),
        "mass": mass["cap"],
    }
    root = {"stiffness": record["ends"]["root_cap_over_cap_stiffness"] * stiffness_of(cap)}
    middle = {
        "chamber": True,
        "length": geometry["chamber_length_mm"] * _MM / PIECES,
        "place": (axis["x_mm"] * _MM, axis["y_mm"] * _MM),
        "stiffness": line.stiffness,
        "mass": mass["section"],
    }
    parts = (
        ("root", beside | root, CAP_PIECES),
        ("chamber", middle, PIECES),
        ("tip", beside, CAP_PIECES),
    )
    added = iter(added_of(record))
    return [
        _Piece(name=f"{name}_{number}", added=moved(next(added), part["place"]), **part)
        for name, part, count in parts
        for number in range(count)
    ]


def added_of(record: dict[str, Any]) -> list[Floats]:
    """What each piece is longer and turns further by an end, (n, 4), m and rad, from the root."""
    ends, geometry = record["ends"], record["geometry"]
    near = round(ends["zone_mm"] / geometry["chamber_length_mm"] * PIECES)
    near = max(1, min(near, PIECES // 2))
    nothing = np.zeros((len(record["section"]["pressure_kPa"]), 4))
    counts = dict(zip(KEYS, (CAP_PIECES, near, near, CAP_PIECES), strict=True))
    root, begin, end, tip = (
        [np.array([ends[key][name] for name in ADDED]).T * [_MM, 1, 1, 1] / count] * count
        for key, count in counts.items()
    )
    return [*root, *begin, *[nothing] * (PIECES - 2 * near), *end, *tip]


def moved(added: Floats, place: tuple[float, float]) -> Floats:
    """What a line at x, y from the centroids is longer, and the same turns, (n, 4), m and rad."""
    out = added.copy()
    out[:, 0] += place[1] * added[:, 1] - place[0] * added[:, 2]
    return out


def _body(record: dict[str, Any], pieces: list[_Piece], line: Line) -> Iterator[str]:
    """Bodies within each other, each from the middle of a piece to that of the next."""
    radius, damping = record["geometry"]["radius_mm"] * _MM, damping_time(record)
    centre = np.mean(np.array(record["geometry"]["outline_mm"]), axis=0) * _MM
    bottom = -record["geometry"]["cap_length_mm"] * _MM
    at = np.array([0.0, 0.0, bottom])
    for number, piece in enumerate(pieces):
        joint = np.array([*piece.place, bottom + piece.length / 2])
        pad = "      " + "  " * number
        yield f'{pad}<body name="{piece.name}" pos="{_row(joint - at)}">'
        joints = zip(JOINTS, piece.stiffness / piece.length, strict=True)
        # turns do not commute: bend first in one piece and last in the next, errors cancel
        for name, stiffness in sorted(joints, key=lambda one: _ORDER[number % 2].index(one[0])):
            kind = "slide" if name == "stretch" else "hinge"
            # the line of the centroids stays across the sections, as in a rod without shear
            about = -np.array([*piece.place, 0.0]) if name == "twist" else np.zeros(3)
            yield (
                f'{pad}  <joint name="{name}_{piece.name}" type="{kind}" axis="{_AXES[name]}" '
                f'pos="{_row(about)}" '
                f'stiffness="{stiffness:.10g}" damping="{damping * stiffness:.6g}" '
                f'armature="{stiffness * (TIME_STEP / RESOLVED) ** 2:.6g}"/>'
            )
        last = number + 1 == len(pieces)
        halves = [(piece, piece.length / 4)]
        if not last:
            after = pieces[number + 1]
            halves.append((after, piece.length / 2 + after.length / 4))
        mass, place, inertia = _together(halves, piece.place)
        xx, yy, zz, xy, xz, yz = (inertia[i, j] for i, j in _FULL)
        yield (
            f'{pad}  <inertial mass="{mass:.10g}" pos="{_row(place)}" '
            f'fullinertia="{_row(np.array([xx, yy, zz, xy, xz, yz]))}"/>'
        )
        end = piece.length / 2 + (0.0 if last else pieces[number + 1].length / 2)
        x, y = centre - np.array(piece.place)
        yield (
            f'{pad}  <geom type="cylinder" size="{radius:.6g}" contype="1" conaffinity="0" '
            f'fromto="{_row(np.array([x, y, 0.0, x, y, end]))}"/>'
        )
        at = joint
        bottom += piece.length
    x, y = -np.array(pieces[-1].place)
    pad = "      " + "  " * len(pieces)
    yield f'{pad}<site name="tip" pos="{_row(np.array([x, y, pieces[-1].length / 2]))}"/>'
    for number in reversed(range(len(pieces))):
        yield "      " + "  " * number + "</body>"


_FULL = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def _together(
    halves: list[tuple[_Piece, float]], place: tuple[float, float]
) -> tuple[float, Floats, Floats]:
    """Mass, centre and inertia about it of halves of pieces, seen from a body's own origin.

    Args:
        halves: pieces, and where along the rod the middle of their half is, m.
        place: x, y of the origin from the centroids, m.
    """
    total, moment, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for piece, along in halves:
        about, length = piece.mass, piece.length / 2
        mass = about["per_length_kg_per_mm"] / _MM * length
        x, y = np.array([about["centre_x_mm"], about["centre_y_mm"]]) * _MM - np.array(place)
        arm = np.array([x, y, along])
        xx, yy, xy = np.array(about["second_xx_yy_xy_kg_mm"]) * _MM * length
        own = np.array([[xx, xy, 0.0], [xy, yy, 0.0], [0.0, 0.0, mass * length**2 / 12]])
        total += mass
        moment += mass * arm
        second += own + mass * np.outer(arm, arm)
    centre = moment / total
    second -= total * np.outer(centre, centre)
    return total, centre, np.trace(second) * np.eye(3) - second


def _row(values: Floats) -> str:
    return " ".join(f"{float(value) + 0.0:.10g}" for value in values)


def _safe(title: str) -> str:
    """A title within quotation marks and comments of XML."""
    kept = "".join(letter for letter in title if letter.isalnum() or letter in " ,.:;()")
    return " ".join(kept.split())

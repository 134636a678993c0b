"""What is asked of a trial, and what it answers."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping


@dataclasses.dataclass(frozen=True)
class Wanted:
    """States of a case of uniform bending.

    Attributes:
        angles: bending angles, rad; the pressure is found.
        pressures: pressures, MPa; the angle is found.
        straight: pressures, MPa, under which it is kept straight; the moment is found.
    """

    angles: tuple[float, ...] = ()
    pressures: tuple[float, ...] = ()
    straight: tuple[float, ...] = ()


@dataclasses.dataclass(frozen=True)
class Point:
    """One state, of the whole actuator.

    Attributes:
        pressure: MPa.
        angle: bending angle, rad.
        side_angle: the same to the side, rad; zero where symmetry keeps it from that.
        twist: turn of the sections about the centre-line, rad; likewise.
        stretch: of the centre-line.
        moment: that keeps it straight, about its centroid, N mm; zero where nothing holds it.
        torque: of effect hold, N mm; zero where nothing holds it.
        tip_force: the moment over the length of the cap, N: the force of a blocked tip as a sweep
            reports it, whose meaning the model's `force_remark` says.
        strain: greatest logarithmic principal strain of the rubber.
        fiber_low: least axial force in a fiber, N; zero without fibers.
        fiber_high: greatest axial force in a fiber, N.
        volume: of the chamber, mm³.
        volume_at_rest: the same without pressure.
        work: stored energy, N mm, of rubber and fibers: what all loads have done since rest. Where
            pressure alone acts it is ∫ p dV along the way, to the tolerance of the solution.
    """

    pressure: float
    angle: float
    side_angle: float
    twist: float
    stretch: float
    moment: float
    torque: float
    tip_force: float
    strain: float
    fiber_low: float
    fiber_high: float
    volume: float
    volume_at_rest: float
    work: float


@dataclasses.dataclass(frozen=True)
class Answer:
    """The states that were found.

    Attributes:
        free: by the wanted angles and then by the wanted pressures, in their order; those that were
            not found are left out.
        straight: by the wanted pressures, likewise.
        converged: all were found.
        reason: why not; empty where they were.
        remarks: what casts doubt on the calibration of its winding, a line each.
        calibration_error: percent of pressure and moment by which a calibration that was taken over
            from a like case may be off; 0 of its own.
    """

    free: tuple[Point, ...] = ()
    straight: tuple[Point, ...] = ()
    converged: bool = True
    reason: str = ""
    remarks: tuple[str, ...] = ()
    calibration_error: float = 0.0


@dataclasses.dataclass(frozen=True)
class Slopes:
    """Derivatives of an answer.

    Attributes:
        answer: the states.
        by_field: by the path of a number of the case, the same states with the derivative of each
            of their quantities in its place, in its unit over that of the number: MPa/mm.
    """

    answer: Answer
    by_field: Mapping[str, Answer]


@dataclasses.dataclass(frozen=True)
class BlockedForce:
    """What a sweep reports as `blocked_force_N`.

    Attributes:
        force: N; None where it was not found.
        named: whose force it is, as a table names it.
        remark: how it compares with a body's, with the source; empty where it is one.
        reason: why it was not found; empty where it was.
    """

    force: float | None
    named: str
    remark: str
    reason: str = ""

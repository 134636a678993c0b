"""Whether there is room for threads: over each other, around the body, on its length."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from fiberbend.effects.wound.family import Around, FamilySpec
from fiberbend.schema.problems import Problem
from fiberbend.schema.units import show
from geometry.winding.families import wall_reach
from geometry.winding.symmetry import least_distance

if TYPE_CHECKING:
    from geometry.actuator import Actuator
    from geometry.winding.families import Family

ROUNDING = 1e-9


def thickness(path: str, diameter: float, actuator: Actuator) -> Iterator[Problem]:
    """A thread thicker than what it lies in."""
    if actuator.sheath is not None:
        under = min(actuator.wall, actuator.profile.bottom - actuator.outline_bottom)
        most, place = under + actuator.sheath, "wall or floor and sheath together"
    else:
        high = actuator.outline_top - actuator.outline_bottom
        most, place = min(2 * actuator.outline_half_width, high), "the body within"
    if diameter > most * (1 + ROUNDING):
        yield Problem(
            path,
            f"a thread {diameter:.4g} mm thick, expected one not thicker than {place}, "
            f"{most:.4g} mm",
        )


def rounded(actuator: Actuator) -> bool:
    """Whether a thread around it is curved anywhere but at corners."""
    return any(side.center is not None for side in actuator.outline())


def rounded_up(length: float) -> float:
    """The next length of four digits."""
    step = 10.0 ** (math.floor(math.log10(length)) - 3)
    return float(f"{math.ceil(length / step) * step:.4g}")


def of_families(
    path: str,
    specs: Sequence[FamilySpec],
    wide: Sequence[float],
    around: Around,
    actuator: Actuator,
) -> Iterator[Problem]:
    """Families that lie over themselves or over others of one direction, or nowhere at all.

    Args:
        path: of the winding.
        specs: its families, each valid by itself.
        wide: of thread or ribbon of each, mm.
        around: where threads lie that do not say.
        actuator: what they are wound around.
    """
    where = [spec.around or around for spec in specs]
    reach = wall_reach(actuator)
    if reach is None and "wall" in where:
        number = where.index("wall")
        given = specs[number].around is not None
        text = f'"wall", but a {actuator.section} has no floor to leave out, expected all'
        yield Problem(f"{path}.families.{number}.around" if given else f"{path}.around", text)
        return
    laid = [spec.laid(actuator, around) for spec in specs]
    for number, (spec, families) in enumerate(zip(specs, laid, strict=True)):
        own = f"{path}.families.{number}"
        yield from _by_itself(own, spec, families[0], wide[number], actuator)
        for place, family in enumerate(families):
            if family.place and _aside(family, actuator) > family.reach * (1 + ROUNDING):
                yield Problem(f"{own}.at.{place}", "a place on the floor, expected one on the wall")
    lines = [(number, family) for number, families in enumerate(laid) for family in families]
    for (one, first), (other, second) in itertools.combinations(lines, 2):
        if first.hand != second.hand or abs(first.angle - second.angle) > ROUNDING:
            continue
        apart, needed = least_distance(first, second), (wide[one] + wide[other]) / 2
        if apart < needed * (1 - ROUNDING):
            of = "itself" if one == other else f"families.{one}"
            yield Problem(
                f"{path}.families.{other}",
                f"lies over {of}: threads of one direction {apart:.3g} mm apart where they are "
                f"{needed:.3g} mm wide, expected another phase or another place",
            )


def _aside(family: Family, actuator: Actuator) -> float:
    perimeter = actuator.winding_perimeter
    return min(family.offset % perimeter, -family.offset % perimeter)


def _by_itself(
    path: str, spec: FamilySpec, family: Family, wide: float, actuator: Actuator
) -> Iterator[Problem]:
    if not family.angle and spec.at is not None:
        return
    if wide > family.spacing * (1 + ROUNDING):
        text = (
            f"lays its threads over each other, {family.spacing:.3g} mm apart where they are "
            f"{wide:.3g} mm wide, expected "
        )
        starts, perimeter = spec.starts or 1, actuator.winding_perimeter
        most = math.floor(family.spacing * starts / wide * (1 + ROUNDING))
        if not family.hand and family.angle:
            wanted, key = f'at least "{show(rounded_up(wide), "length")}"', "spacing"
        elif most:
            wanted, key = f"at most {most}", "starts"
        elif wide < perimeter:
            # cos α = wide/S
            degrees = math.degrees(math.acos(min(1.0, wide / perimeter)))
            wanted, key = f"at most {math.floor(degrees * 1e3) / 1e3:.6g}° from the axis", ""
            key = "angle_from_axis" if spec.pitch is None else "pitch"
        else:
            wanted, key = "a thinner thread", "fiber"
        yield Problem(f"{path}.{key}", text + wanted)
    if family.angle and not family.hand:
        first = family.offset % family.spacing
        if first > actuator.length * (1 + ROUNDING):
            yield Problem(
                f"{path}.spacing",
                f'"{show(family.spacing, "length")}", but no hoop lies on the chamber, the first '
                f"one at z = {first:.4g} mm, expected less, or a phase of 0",
            )

"""Threads as families say: each with its angle, its hand, its starts and its fiber."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from fiberbend.effects.wound.family import Around, FamilySpec
from fiberbend.effects.wound.room import of_families, thickness
from fiberbend.effects.wound.threads import POINTS_A_TURN, Threads
from fiberbend.effects.wound.turns import Turns
from fiberbend.schema.problems import Problem
from fiberbend.schema.units import show
from geometry.winding.families import Family
from geometry.winding.symmetry import (
    FEW,
    common_period,
    mirrored,
    nearest_periods,
    reversible,
    twofold,
)

if TYPE_CHECKING:
    from fiberbend.states.snapshot import FamilyLook
    from geometry.actuator import Actuator
    from geometry.mesh.data import Floats
    from geometry.winding.ribbons import Ribbons
    from materials.fiber import Fiber

_TIGHT = math.radians(80)
"""Angle from the axis from which threads all around fix the circumference."""
_ANY = (1.0, math.pi)
"""Perimeters in mm: what holds on both hangs on none."""


@dataclasses.dataclass(frozen=True)
class ByFamilies(Threads):
    """Families, each where it says or where the winding lies.

    Attributes:
        specs: as the case has them, each valid by itself.
        each: what each is made of.
        around: where those lie that do not say.
    """

    specs: tuple[FamilySpec, ...]
    each: tuple[Fiber, ...]
    around: Around

    @property
    def fibers(self) -> tuple[Fiber, ...]:
        """Each once, in the order of the families."""
        return tuple(dict.fromkeys(self.each))

    @property
    def upright(self) -> bool:
        """All at 0° from the axis."""
        return all(spec.angle == 0 for spec in self.specs)

    def _laid(self, perimeter: float, actuator: Actuator | None = None) -> list[Family]:
        """All of them; without an actuator what is not under a floor ends anywhere."""
        kinds, found = self.fibers, []
        for spec, fiber in zip(self.specs, self.each, strict=True):
            if actuator is None:
                bounded = (spec.around or self.around) == "wall"
                families = spec.on(perimeter, perimeter / 4 if bounded else math.inf)
            else:
                families = spec.laid(actuator, self.around)
            number = kinds.index(fiber)
            found += [dataclasses.replace(family, thread=number) for family in families]
        return found

    def breaker(self, spread: bool) -> str:
        """Families that are not those of the other hand and side too."""
        alike = all(mirrored(self._laid(perimeter), spread) for perimeter in _ANY)
        return "" if alike else "the families of the winding are not their own mirror image"

    def end_breaker(self, spread: bool) -> str:
        """Families that are not those of the other hand too."""
        if not self.breaker(spread) and not self.turn_breaker(spread):
            return ""
        alike = all(reversible(self._laid(perimeter), spread) for perimeter in _ANY)
        return "" if alike else "the families of the winding are not alike forward and backward"

    def turn_breaker(self, spread: bool) -> str:
        """Threads along the axis on one side, or turns that start anywhere."""
        if all(twofold(self._laid(perimeter), spread) is not None for perimeter in _ANY):
            return ""
        return "no half turn about a line along y maps the families of the winding onto themselves"

    def assumed(self) -> Iterator[str]:
        """Rigid, without angles and twist."""
        yield "the winding fixes the circumference; angles of its families do not enter"
        if self.breaker(True):
            yield "the twist of its families is not in it"

    def turns(
        self, actuator: Actuator, discrete: bool, spread: bool, bulges: bool, lines: int
    ) -> Turns:
        """Of all families together."""
        families = self._laid(actuator.winding_perimeter, actuator)
        periods = [family.period for family in families if math.isfinite(family.period)]
        upward = [max(1, family.threads) for family in families if family.hand or not family.angle]
        in_turns = discrete and bool(periods)
        return Turns(
            pitch=None,
            spacing=min(periods, default=math.inf),
            period=common_period(families),
            origin=twofold(families, spread),
            discrete=in_turns,
            twists=bool(self.breaker(spread)),
            stiffness=max(fiber.stiffness for fiber in self.each),
            modulus=min(fiber.modulus for fiber in self.each),
            curves=lines * sum(upward) if in_turns else len(families),
            around=lines * sum(1 / period for period in periods),
            bulges=bulges,
            tight=all(f.angle >= _TIGHT and math.isinf(f.reach) for f in families),
            misfit=self._misfit(families),
        )

    def _misfit(self, families: list[Family]) -> str:
        """Why nothing repeats within a few turns, with the pitches nearest to one that does."""
        if common_period(families) is not None:
            return ""
        last = max(range(len(families)), key=lambda n: _finite(families[n].period))
        offers = []
        for number, (spec, family) in enumerate(self._by_spec(families)):
            if family is families[last] or common_period([family, families[last]]) is not None:
                continue
            key = "spacing" if not family.hand else "pitch"
            starts = spec.starts or 1
            near = [
                f'"{show(float(f"{fit * starts:.10g}"), "length")}"'
                for fit in nearest_periods([family, families[last]], 0)
            ]
            offers.append(f"families.{number} with a {key} of {' or '.join(near)}")
        return (
            f"its families do not repeat together within {FEW} turns: expected "
            f"{' and '.join(offers)}, or as: smeared, or model body"
        )

    def _by_spec(self, families: list[Family]) -> Iterator[tuple[FamilySpec, Family]]:
        """Every family that goes around, with what the case says of it."""
        left = iter(families)
        for spec in self.specs:
            found = [next(left) for _ in range(_places(spec))]
            yield spec, found[0]

    def room(self, path: str, actuator: Actuator, width: float) -> Iterator[Problem]:
        """Threads over each other, on the floor that is left out, or too thick."""
        wide = [max(fiber.diameter, width) for fiber in self.each]
        yield from of_families(path, self.specs, wide, self.around, actuator)
        for number, (spec, fiber) in enumerate(zip(self.specs, self.each, strict=True)):
            own = f"{path}.fiber" if spec.fiber is None else f"{path}.families.{number}.fiber"
            yield from thickness(own, fiber.diameter, actuator)

    def ribbons(self, actuator: Actuator, width: float | None, lines: int) -> Ribbons:
        """All of them, as wide as their threads or all as wide."""
        from geometry.winding.ribbons import Ribbons

        kinds, found = self.fibers, []
        for family in self._laid(actuator.winding_perimeter, actuator):
            own = kinds[family.thread].diameter if width is None else width
            found.append(dataclasses.replace(family, width=own))
        return Ribbons(tuple(found), lines)

    def curves(self, actuator: Actuator, width: float | None, lines: int) -> list[Floats]:
        """Every line of every thread."""
        return self.ribbons(actuator, width, lines).curves(actuator, POINTS_A_TURN)

    def looks(self, actuator: Actuator) -> list[FamilyLook]:
        """Angle and hand; the mirror image has the other hand, and the same thread."""
        from fiberbend.states.snapshot import FamilyLook

        families = self._laid(actuator.winding_perimeter, actuator)
        names = [_look(family) for family in families]
        if len(set(names)) < len(self.specs):
            # more than one at the same angle and hand: their places in the case
            numbers = [n for n, spec in enumerate(self.specs) for _ in range(_places(spec))]
            names = [f"{name} (families.{n})" for name, n in zip(names, numbers, strict=True)]
        keys = [(round(f.angle, 9), f.hand, f.thread, round(f.spacing, 9)) for f in families]
        return [
            FamilyLook(name, next((k for k, other in enumerate(keys) if other == image), number))
            for number, (name, (angle, hand, thread, apart)) in enumerate(
                zip(names, keys, strict=True)
            )
            for image in [(angle, -hand, thread, apart)]
        ]

    def words(self, perimeter: float) -> list[str]:
        """Angle, pitch, starts, spacing and hand of each."""
        return [
            f"families.{number}: {spec.words(perimeter, self.around)}"
            for number, spec in enumerate(self.specs)
        ]


def _places(spec: FamilySpec) -> int:
    """Families of the geometry that one of a case is: one for each place of a thread."""
    return 1 if spec.at is None or spec.angle != 0 else len(spec.at)


def _look(family: Family) -> str:
    """Angle from the axis and hand."""
    if not family.angle:
        return "0° from the axis"
    if not family.hand:
        return "hoops"
    return f"{math.degrees(family.angle):.4g}° {'right' if family.hand > 0 else 'left'}"


def _finite(period: float) -> float:
    return period if math.isfinite(period) else 0.0

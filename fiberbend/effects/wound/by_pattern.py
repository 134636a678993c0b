"""Threads as a pattern says: its helices, all with one pitch and one fiber."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from fiberbend.effects.wound.room import ROUNDING, rounded_up, thickness
from fiberbend.effects.wound.threads import POINTS_A_TURN, Threads
from fiberbend.effects.wound.turns import Turns
from fiberbend.schema.problems import Problem
from fiberbend.schema.units import show
from geometry.winding.patterns import PATTERNS, Pattern, least_pitch, turn_spacing

if TYPE_CHECKING:
    from fiberbend.states.snapshot import FamilyLook
    from geometry.actuator import Actuator
    from geometry.mesh.data import Floats
    from geometry.winding.ribbons import Ribbons
    from materials.fiber import Fiber


@dataclasses.dataclass(frozen=True)
class ByPattern(Threads):
    """A pattern around the whole outline.

    Attributes:
        name: of the pattern.
        pitch: rise of a turn, mm.
        fiber: of all helices.
    """

    name: str
    pitch: float
    fiber: Fiber

    @property
    def _pattern(self) -> Pattern:
        return PATTERNS[self.name]

    @property
    def fibers(self) -> tuple[Fiber, ...]:
        """One for all."""
        return (self.fiber,)

    @property
    def upright(self) -> bool:
        """Helices go around."""
        return False

    def breaker(self, spread: bool) -> str:
        """A pattern with a hand."""
        pattern = self._pattern
        return "" if pattern.mirrored else f"{pattern.meaning} is not its own mirror image"

    def end_breaker(self, spread: bool) -> str:
        """A pattern with a hand: both mirror planes change it."""
        return self.breaker(spread)

    def turn_breaker(self, spread: bool) -> str:
        """Half a turn about y keeps the hand, and moves the starts of turns."""
        pattern = self._pattern
        if spread or pattern.turned:
            return ""
        return f"half a turn about y does not map {pattern.meaning} onto itself"

    def assumed(self) -> Iterator[str]:
        """Rigid, without pitch and twist."""
        yield "the winding fixes the circumference; its pitch does not enter"
        if not self._pattern.mirrored:
            yield f"the twist of {self._pattern.meaning} is not in it"

    def turns(
        self, actuator: Actuator, discrete: bool, spread: bool, bulges: bool, lines: int
    ) -> Turns:
        """Pitch, pattern and thread."""
        curves = lines * len(self._pattern.helices)
        return Turns(
            pitch=self.pitch,
            spacing=self.pitch,
            period=self.pitch,
            origin=0.0,
            discrete=discrete,
            twists=not self._pattern.mirrored,
            stiffness=self.fiber.stiffness,
            modulus=self.fiber.modulus,
            curves=curves,
            around=curves / self.pitch,
            bulges=bulges,
        )

    def room(self, path: str, actuator: Actuator, width: float) -> Iterator[Problem]:
        """Turns over each other, or a thread too thick."""
        diameter = self.fiber.diameter
        wide, what = (diameter, "thread") if diameter >= width else (width, "ribbon")
        perimeter = actuator.winding_perimeter
        apart = turn_spacing(self.name, self.pitch, perimeter)
        if wide > apart * (1 + ROUNDING):
            least = least_pitch(self.name, wide, perimeter)
            wanted = f"a thinner {what}"
            if least is not None:
                wanted = f'at least "{show(rounded_up(least), "length")}" or {wanted}'
            yield Problem(
                f"{path}.pitch",
                f'"{show(self.pitch, "length")}" lays the turns over each other, {apart:.3g} mm '
                f"apart where the {what} is {wide:.3g} mm wide, expected {wanted}",
            )
        yield from thickness(f"{path}.fiber", diameter, actuator)

    def ribbons(self, actuator: Actuator, width: float | None, lines: int) -> Ribbons:
        """A family for every helix."""
        from geometry.winding.helix import Winding

        width = self.fiber.diameter if width is None else width
        return Winding(self.name, self.pitch, width, lines).ribbons(actuator)

    def curves(self, actuator: Actuator, width: float | None, lines: int) -> list[Floats]:
        """Every line of every helix."""
        from geometry.winding.helix import Winding

        width = self.fiber.diameter if width is None else width
        helix = Winding(self.name, self.pitch, width, lines)
        count = math.ceil(actuator.length / self.pitch) * POINTS_A_TURN
        return [helix.points(actuator, curve, count)[0] for curve in range(helix.curves)]

    def looks(self, actuator: Actuator) -> list[FamilyLook]:
        """All of one name, as turns of a thread; a mirror image is that of the other hand."""
        from fiberbend.states.snapshot import FamilyLook

        hands = [helix.hand for helix in self._pattern.helices]
        images = [hands.index(-h) if -h in hands else n for n, h in enumerate(hands)]
        return [FamilyLook("fiber", image) for image in images]

    def words(self, perimeter: float) -> list[str]:
        """The case says it."""
        return []

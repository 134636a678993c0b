"""What a winding asks of its threads, whether a pattern or families say how they run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Protocol

from fiberbend.effects.wound.turns import Turns
from fiberbend.schema.problems import Problem

if TYPE_CHECKING:
    from fiberbend.states.snapshot import FamilyLook
    from geometry.actuator import Actuator
    from geometry.mesh.data import Floats, Ints
    from geometry.winding.ribbons import Ribbons
    from materials.fiber import Fiber

POINTS_A_TURN = 24
"""Of a thread in a picture."""


class Threads(Protocol):
    """How the threads of a winding run."""

    @property
    def fibers(self) -> tuple[Fiber, ...]:
        """What they are made of, each once; the number in `Family.thread` is the place here."""

    @property
    def upright(self) -> bool:
        """Whether all run along the axis, so that a section has every one of them."""

    def breaker(self, spread: bool) -> str:
        """Why x = 0 is no mirror plane of them; empty where it is one.

        Args:
            spread: they are smeared, so that directions count alone.
        """

    def end_breaker(self, spread: bool) -> str:
        """Why no plane across the axis is a mirror plane of them; empty where one is."""

    def turn_breaker(self, spread: bool) -> str:
        """Why half a turn about a line along y does not map them onto themselves; else empty."""

    def assumed(self) -> Iterator[str]:
        """What the closed form assumes of them, one sentence each."""

    def turns(
        self, actuator: Actuator, discrete: bool, spread: bool, bulges: bool, lines: int
    ) -> Turns:
        """What the rest of the program asks of them.

        Args:
            actuator: what they are wound around.
            discrete: every turn by itself.
            spread: smeared, without bulges.
            bulges: smeared, with bulges.
            lines: of a ribbon, 1 where they are not discrete.
        """

    def room(self, path: str, actuator: Actuator, width: float) -> Iterator[Problem]:
        """Threads or ribbons that lie over each other, or that no place around the body holds."""

    def ribbons(self, actuator: Actuator, width: float | None, lines: int) -> Ribbons:
        """As the geometry takes them.

        Args:
            actuator: what they are wound around.
            width: of a ribbon, mm; None: the diameter of its thread.
            lines: of a ribbon.
        """

    def curves(self, actuator: Actuator, width: float | None, lines: int) -> list[Floats]:
        """Every line of the ribbons in space, (n, 3), mm; see `ribbons`."""

    def looks(self, actuator: Actuator) -> list[FamilyLook]:
        """By the number that a family has in `ribbons`; empty where none is told apart."""

    def words(self, perimeter: float) -> list[str]:
        """How they run, a line for each family, as a plan shows it; may be empty."""


def stiffness_of(threads: Threads, laid: Ribbons, which: Ints) -> float | Floats:
    """EA in N of the thread of every segment, or of all where there is one."""
    import numpy as np

    each = [fiber.stiffness for fiber in threads.fibers]
    if len(each) == 1:
        return each[0]
    return np.array([each[family.thread] for family in laid.families])[which]

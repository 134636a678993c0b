"""What every quantity answers that a design can ask for."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, ClassVar, Generic, TypeVar

from pydantic import Field

from fiberbend.answer.numbers import number
from fiberbend.case.case import Case
from fiberbend.design.quantities.seen import Seen, State
from fiberbend.schema.problems import Problem
from fiberbend.schema.quantities import Spec
from fiberbend.schema.units import KINDS, show

V = TypeVar("V")

WITHIN = 0.02
"""Part of a value within which it is met, where a file does not say."""
SIZE_WITHIN = 1e-3
"""The same of what dimensions give, in which no model is off."""
_SIGNS = {"deg": "°", "N*mm": " N mm"}
"""Units as a person writes them, with what stands before."""


class Quantity(Spec, Generic[V]):
    """A quantity with what is wanted of it: `is`, or `least` and `most`; of a goal, nothing.

    A subclass says what it is: name, kind of its values, the states that it needs, and how it is
    read off them.
    """

    name: ClassVar[str]
    """How a file calls it."""
    kind: ClassVar[str]
    """Key of `fiberbend.schema.units.KINDS`."""
    small: ClassVar[float]
    """A value that hardly counts, in the internal unit: zero is missed by parts of it."""

    is_: V | None = Field(default=None, alias="is")
    """The value that it is to have."""
    within: V | None = None
    """How far from that it may be and still be met; 2 % of the value by default."""
    least: V | None = None
    """The least value that is allowed."""
    most: V | None = None
    """The greatest value that is allowed."""

    def states(self) -> tuple[State, ...]:
        """States from which it is read; none where dimensions are enough."""
        return ()

    def read(self, seen: Seen) -> float:
        """Its value in the internal unit of its kind."""
        raise NotImplementedError

    def words(self) -> str:
        """What it is, such as "angle at 60 kPa"."""
        return self.name.replace("-", " ")

    def wrong(self, path: str, case: Case) -> Iterator[Problem]:
        """Why a case has no such quantity.

        Args:
            path: of the quantity in the design file.
            case: the base case.
        """
        yield from ()

    def blocked_by(self) -> dict[str, Any]:
        """The effect by which a body shows it, as a case file has it; empty: it bends freely."""
        return {}

    def bare(self) -> Quantity[V]:
        """The quantity alone, without what is wanted of it."""
        nothing = {"is_": None, "within": None, "least": None, "most": None}
        return self.model_copy(update=nothing)

    # --- what is wanted of it --------------------------------------------------------------------

    @property
    def wants(self) -> tuple[str, ...]:
        """Keys that are given of `is`, `least` and `most`."""
        given = {"is": self.is_, "least": self.least, "most": self.most}
        return tuple(key for key, value in given.items() if value is not None)

    @property
    def scale(self) -> float:
        """Size of what is wanted, by which misses are measured; never zero."""
        return max(self.small, self._size)

    @property
    def _size(self) -> float:
        given = (self.is_, self.least, self.most)
        return max((abs(value) for value in given if isinstance(value, float)), default=0.0)

    @property
    def slack(self) -> float:
        """How far from `is` it may be, or beyond a bound, and be met."""
        if isinstance(self.within, float):
            return self.within
        return (WITHIN if self.states() else SIZE_WITHIN) * (self._size or self.small)

    def bounds(self) -> tuple[float, float]:
        """Least and greatest value that are wanted; ±inf where there is no bound."""
        if isinstance(self.is_, float):
            return self.is_, self.is_
        low = self.least if isinstance(self.least, float) else -math.inf
        high = self.most if isinstance(self.most, float) else math.inf
        return low, high

    def shown(self, value: float) -> str:
        """A value as a person reads it, in the usual unit."""
        kind = KINDS[self.kind]
        scaled = value / float(kind.factors[kind.shown])
        unit = _SIGNS.get(kind.shown, f" {kind.shown}")
        return f"{number(scaled)}{unit}"

    def plain(self, value: float) -> float:
        """A value in the usual unit."""
        kind = KINDS[self.kind]
        return value / float(kind.factors[kind.shown])

    @property
    def unit(self) -> str:
        """The usual unit of its values."""
        return KINDS[self.kind].shown

    def wanted(self) -> str:
        """What is wanted of it in words, such as "90°" or "at most 20 mm"."""
        if isinstance(self.is_, float):
            return self.shown(self.is_)
        parts = []
        if isinstance(self.least, float):
            parts.append(f"at least {self.shown(self.least)}")
        if isinstance(self.most, float):
            parts.append(f"at most {self.shown(self.most)}")
        return ", ".join(parts)


def contradictions(asked: Quantity[Any], path: str, goal: bool) -> Iterator[Problem]:
    """What is wrong with what is wanted of a quantity.

    Args:
        asked: the quantity.
        path: where it stands in the design file.
        goal: it is minimised or maximised.
    """
    if goal:
        for key in (*asked.wants, *(("within",) if asked.within is not None else ())):
            yield Problem(f"{path}.{key}", "no effect in a goal, expected it under targets")
        return
    if not asked.wants:
        yield Problem(path, "nothing is wanted of it, expected is, least or most")
    if asked.is_ is not None and len(asked.wants) > 1:
        yield Problem(f"{path}.is", "beside least or most, expected it alone")
    if asked.within is not None:
        if asked.is_ is None:
            yield Problem(f"{path}.within", "no effect without is, expected no value")
        elif not float(asked.within) > 0:
            yield Problem(f"{path}.within", "expected a value above zero")
    low, high = asked.bounds()
    if low > high:
        shown = show(low, asked.kind)
        yield Problem(f"{path}.most", f"{show(high, asked.kind)}, expected at least {shown}")


def at_words(pressure: float | None, angle: float | None = None) -> str:
    """A state in words, "at 60 kPa" or "at 90°"."""
    if pressure is not None:
        return f"at {number(1e3 * pressure, digits=6)} kPa"
    return f"at {number(math.degrees(angle or 0.0), digits=6)}°"


def zone_words(zone: int | None) -> str:
    """Which part of an actuator is meant; nothing for all of it."""
    return "" if zone is None else f" of zone {zone}"


def zone_problems(path: str, zone: int | None, case: Case) -> Iterator[Problem]:
    """A zone that a case does not have."""
    count = len(case.zones or ())
    if zone is not None and zone > count:
        has = f"{count} zones" if count else "no zones"
        yield Problem(f"{path}.zone", f"{zone}, but the case has {has}")

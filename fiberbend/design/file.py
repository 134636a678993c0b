"""A design file: a base case, the fields that may change, and what is wanted.

The classes check the file's own values. `fiberbend.design.reading.read_design` reads a file: it
also checks the base case and the ends of every field, and reports every problem at once.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, Field, field_validator
from pydantic_core import PydanticCustomError

from fiberbend.design.quantities.quantity import Quantity, contradictions
from fiberbend.design.quantities.table import QuantityEntry, unwrap
from fiberbend.schema.problems import Problem
from fiberbend.schema.quantities import Spec

if TYPE_CHECKING:
    AnyQuantity = Quantity[Any]
else:
    AnyQuantity = Annotated[QuantityEntry, AfterValidator(unwrap)]

MOST_GOALS = 2
MOST_COMBINATIONS = 64
"""Combinations of choices and whole numbers, each of which is searched by itself."""


class Goal(Spec):
    """A quantity that is to be as small or as great as it can be."""

    minimise: AnyQuantity | None = None
    """As small as it can be."""
    maximise: AnyQuantity | None = None
    """As great as it can be."""

    @property
    def quantity(self) -> Quantity[Any]:
        """What is minimised or maximised."""
        found = self.minimise if self.minimise is not None else self.maximise
        assert found is not None
        return found

    @property
    def sign(self) -> float:
        """1 of what is to be small, −1 of what is to be great."""
        return 1.0 if self.minimise is not None else -1.0

    def words(self) -> str:
        """The goal, such as "least outer width"."""
        return f"{'least' if self.sign > 0 else 'greatest'} {self.quantity.words()}"


class Search(Spec):
    """How long and from where the search looks."""

    starts: int = Field(default=8, ge=1, le=256)
    """Cases at which it looks first, for each combination of choices."""
    descents: int = Field(default=2, ge=1, le=32)
    """How many of the best of them it improves, for each combination."""
    seed: int = Field(default=0, ge=0)
    """Of the places of the first cases: the same seed, the same answer."""
    front: int = Field(default=7, ge=3, le=50)
    """Points of a trade-off between two goals."""
    mesh: int = Field(default=1, ge=1, le=4)
    """Refinement of the section in the search, as mesh.section; the confirmation has the case's."""


class DesignFile(Spec):
    """A design file."""

    title: str = ""
    """A line for the reader."""
    case: Any
    """The base case: the path of a case file, seen from the design file, or a case itself."""
    set: dict[str, Any] = Field(default={})
    """Changes to the base case, by dotted path."""
    vary: dict[str, Any]
    """Fields that may change, by dotted path: `{from: 1 mm, to: 3 mm}`, or a list of choices."""
    targets: tuple[AnyQuantity, ...] = Field(default=(), strict=False)
    """What is wanted; all of it."""
    goals: tuple[Goal, ...] = Field(default=(), strict=False)
    """What is best among cases that have all of that; two give a trade-off."""
    search: Search = Search()
    """How it searches."""
    confirm: Literal["body", "cell", "none"] = "body"
    """Models in which the answer is confirmed: the cell and the whole body, the cell, or none."""

    @field_validator("case")
    @classmethod
    def _path_or_mapping(cls, case: Any) -> Any:
        if not isinstance(case, str | dict):
            raise PydanticCustomError("case", "expected the path of a case file, or a case")
        return case


def problems(file: DesignFile) -> Iterator[Problem]:
    """What is wrong with a design file beyond its single values and its fields."""
    if not file.vary:
        yield Problem("vary", "nothing varies, expected fields of the case")
    if not file.targets and not file.goals:
        yield Problem("targets", "nothing is wanted, expected targets, goals or both")
    for index, target in enumerate(file.targets):
        yield from contradictions(target, f"targets.{index}.{target.name}", goal=False)
    if len(file.goals) > MOST_GOALS:
        yield Problem("goals", f"{len(file.goals)} goals, expected at most {MOST_GOALS}")
    for index, goal in enumerate(file.goals):
        if (goal.minimise is None) == (goal.maximise is None):
            yield Problem(f"goals.{index}", "expected one of minimise and maximise")
            continue
        key = "minimise" if goal.minimise is not None else "maximise"
        path = f"goals.{index}.{key}.{goal.quantity.name}"
        yield from contradictions(goal.quantity, path, goal=True)
    yield from _together(file)
    if len(file.goals) == MOST_GOALS and not list(_open(file)):
        first, second = (goal.quantity for goal in file.goals)
        if first == second:
            yield Problem("goals.1", "the quantity of goals.0 again, expected another")


def _together(file: DesignFile) -> Iterator[Problem]:
    """What does not go together among all that is wanted."""
    asked = [(f"targets.{index}", target) for index, target in enumerate(file.targets)]
    for index, (place, target) in enumerate(asked):
        for before, other in asked[:index]:
            if target.bare() == other.bare():
                text = f"the quantity of {before} again, expected its least and most in one entry"
                yield Problem(f"{place}.{target.name}", text)
                break
    whole = [goal for goal in file.goals if goal not in list(_open(file))]
    asked += [(f"goals.{index}", goal.quantity) for index, goal in enumerate(whole)]
    posts = [(place, each, by) for place, each in asked if (by := each.blocked_by())]
    for place, each, by in posts[1:]:
        if by != posts[0][2]:
            text = f"another roof or post than that of {posts[0][0]}, expected one for all"
            yield Problem(f"{place}.{each.name}", text)
    pressures = [s.value for _, each in asked for s in each.states() if s.kind == "pressure"]
    if pressures and min(pressures) < 0 < max(pressures):
        yield Problem("targets", "pressures of both signs, expected one: a run goes to one end")


def _open(file: DesignFile) -> Iterator[Goal]:
    """Goals that are not whole."""
    yield from (goal for goal in file.goals if (goal.minimise is None) == (goal.maximise is None))

"""Numbers of a case by dotted paths, in mm, N, MPa and rad."""

from __future__ import annotations

from typing import Any

from fiberbend.case.case import Case
from fiberbend.effects.effect import Effect
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.schema.quantities import Spec


def number(case: Case, path: str) -> float:
    """The number at a path, such as `effects.1.winding.pitch`.

    Args:
        case: a checked case.
        path: as a sweep varies it; coefficients of named materials and fibers too.

    Raises:
        CaseError: there is no number.
    """
    place: Any = case
    for key in path.split("."):
        place = _step(_spelled(place), key)
        if place is None:
            break
    if isinstance(place, bool) or not isinstance(place, int | float):
        raise CaseError([Problem(path, "no number of the case, expected one that it has")])
    return float(place)


def with_number(case: Case, path: str, value: float) -> Case:
    """The case with another number at a path, and all else as it is.

    Neither are ranges checked again, nor defaults made that follow from other numbers when a case
    is read: of a cell whose turns are further apart the elements are as long as they were.

    Args:
        case: a checked case.
        path: of a number that it has.
        value: the number.
    """
    number(case, path)
    changed: Case = _put(case, path.split("."), value)
    return changed


def _spelled(place: Any) -> Any:
    """A named material or fiber by its numbers."""
    return place.by_numbers() if isinstance(place, Spec) else place


def _step(place: Any, key: str) -> Any:
    if isinstance(place, tuple):
        return place[int(key)] if key.isdecimal() and int(key) < len(place) else None
    if isinstance(place, Effect) and key == place.name:
        return place
    return getattr(place, key) if key in getattr(type(place), "model_fields", ()) else None


def _put(place: Any, keys: list[str], value: float) -> Any:
    if not keys:
        return value
    place, (key, *rest) = _spelled(place), keys
    if isinstance(place, tuple):
        index = int(key)
        return (*place[:index], _put(place[index], rest, value), *place[index + 1 :])
    if isinstance(place, Effect) and key == place.name:
        return _put(place, rest, value)
    return place.model_copy(update={key: _put(getattr(place, key), rest, value)})

"""Dotted paths into nested mappings and lists, `effects.1.winding.pitch`."""

from __future__ import annotations

import typing
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from fiberbend.schema.problems import CaseError, Problem
from fiberbend.schema.quantities import Spec


def dotted(location: Iterable[str | int]) -> str:
    """A location as a path, `effects.1.winding.pitch`."""
    return ".".join(map(str, location)) or "case"


def put(data: dict[str, Any], path: str, value: Any) -> None:
    """Put a value at a dotted path of a case that is not yet checked.

    Args:
        data: the case; changed in place.
        path: as in `apply_setting`.
        value: as YAML would give it.

    Raises:
        CaseError: there is no such path.
    """
    keys = path.split(".")
    place: Any = data
    for depth, key in enumerate(keys):
        last = depth == len(keys) - 1
        here = ".".join(keys[: depth + 1])
        if isinstance(place, dict):
            if last:
                place[key] = value
            else:
                place = place.setdefault(key, {})
        elif isinstance(place, list):
            if not key.isdecimal() or int(key) > len(place):
                raise CaseError([Problem(here, f"no such entry, the list has {len(place)}")])
            if int(key) == len(place):
                place.append({})
            if last:
                place[int(key)] = value
            else:
                place = place[int(key)]
        else:
            parent = ".".join(keys[:depth])
            raise CaseError([Problem(here, f"no such path, {parent} is the value {place!r}")])


def value_at(resolved: Any, path: str) -> Any:
    """Value at a dotted path of a resolved case, or None where there is none."""
    for key in path.split("."):
        if isinstance(resolved, Mapping):
            resolved = resolved.get(key)
        elif isinstance(resolved, list) and key.isdecimal() and int(key) < len(resolved):
            resolved = resolved[int(key)]
        else:
            return None
    return resolved


def differences(one: Any, other: Any, path: str = "") -> list[str]:
    """Paths at which two resolved cases differ.

    Args:
        one: a resolved case, or the part of it at `path`.
        other: another.
        path: where both parts stand; empty for whole cases.
    """
    if isinstance(one, dict) and isinstance(other, dict):
        keys = list(dict.fromkeys([*one, *other]))
        steps = [(str(key), one.get(key), other.get(key)) for key in keys]
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        steps = [(str(i), a, b) for i, (a, b) in enumerate(zip(one, other, strict=True))]
    else:
        return [] if one == other else [path]
    dot = f"{path}." if path else ""
    return [line for key, a, b in steps for line in differences(a, b, dot + key)]


def keys(spec: type[Spec]) -> Mapping[str, Any]:
    """The fields of a part of a case by the names that a case gives them."""
    return {field.alias or name: field for name, field in spec.model_fields.items()}


def _specs_in(annotation: Any) -> Iterator[type[Spec]]:
    if isinstance(annotation, type) and issubclass(annotation, Spec):
        yield annotation
    for part in typing.get_args(annotation):
        yield from _specs_in(part)


def specs_at(root: type[Spec], location: Iterable[str | int]) -> list[type[Spec]]:
    """The parts that can stand at a location in the data of a part."""
    specs = [root]
    for part in location:
        if isinstance(part, str):
            specs = [
                inner
                for outer in specs
                if part in keys(outer)
                for inner in _specs_in(keys(outer)[part].annotation)
            ]
    return specs

"""Dotted paths: values are put and found, and differences told, by the same ones."""

from __future__ import annotations

from typing import Any

import pytest

from fiberbend.case.case import Case
from fiberbend.effects.table import WindingEffect
from fiberbend.schema.paths import differences, dotted, put, specs_at, value_at
from fiberbend.schema.problems import CaseError


def test_differences() -> None:
    assert differences({"a": {"b": 1, "c": [1, 2]}}, {"a": {"b": 1, "c": [1, 3]}}) == ["a.c.1"]
    assert differences({"a": [1]}, {"a": [1, 2], "d": 0}) == ["a", "d"]


@pytest.mark.parametrize("path", ["a", "b.0", "b.1", "c.d.e"])
def test_what_is_put_is_there(path: str) -> None:
    data: dict[str, Any] = {"a": 1, "b": [2]}
    before = {"a": 1, "b": [2]}
    put(data, path, 7)
    assert value_at(data, path) == 7
    assert differences(before, data)


@pytest.mark.parametrize("path", ["b.2", "b.x", "a.b"])
def test_a_path_that_leads_nowhere(path: str) -> None:
    data: dict[str, Any] = {"a": 1, "b": [2]}
    assert value_at(data, path) is None
    with pytest.raises(CaseError, match="no such"):
        put(data, path, 7)
    assert data == {"a": 1, "b": [2]}


def test_models_along_a_path() -> None:
    location = ("effects", 1, "winding")
    assert dotted(location) == "effects.1.winding"
    assert specs_at(Case, location[:1]) != []
    assert specs_at(Case, ("actuator", "wall")) == []
    assert WindingEffect not in specs_at(Case, ("actuator",))

"""What pydantic finds wrong, as problems in the words of this project."""

from __future__ import annotations

import re
import typing
from collections.abc import Iterator
from typing import Any

from pydantic import ValidationError

from fiberbend.schema.descriptions import descriptions
from fiberbend.schema.paths import dotted, keys, specs_at
from fiberbend.schema.problems import Problem, found, meant
from fiberbend.schema.quantities import Quantity, Spec

_PLAIN = {
    "model_type": "expected a mapping",
    "dict_type": "expected a mapping",
    "tuple_type": "expected a list",
    "too_short": "expected at least one entry",
    "string_type": "expected text",
    "bool_type": "expected true or false",
    "int_type": "expected a whole number",
    "float_type": "expected a number",
    "int_parsing": "expected a whole number",
    "float_parsing": "expected a number",
    "finite_number": "expected a finite number",
}


def from_pydantic(error: ValidationError, root: type[Spec]) -> Iterator[Problem]:
    """The problems that pydantic found.

    Args:
        error: what pydantic raised.
        root: the class that it was validating.
    """
    for line in error.errors(include_url=False):
        # pydantic counts the valid entries of a list alone
        if line["type"] == "too_short" and line["input"]:
            continue
        yield Problem(dotted(line["loc"]), _text(line, root))


def _text(line: Any, root: type[Spec]) -> str:
    kind, context = line["type"], line.get("ctx", {})
    if kind == "extra_forbidden":
        known = [key for outer in specs_at(root, line["loc"][:-1]) for key in keys(outer)]
        return f"unknown key, expected one of {', '.join(known)}{meant(line['loc'][-1], known)}"
    if kind == "missing":
        return f"missing, expected {_expected(root, line['loc'])}"
    shown = found(line["input"])
    if kind == "literal_error":
        expected = context["expected"].replace("'", "")
        words = re.split(r", | or ", expected)
        return f"{shown}, expected {expected}{meant(line['input'], words)}"
    if kind in ("greater_than", "greater_than_equal", "less_than", "less_than_equal"):
        ((word, bound),) = context.items()
        phrase = {"gt": "more than", "ge": "at least", "lt": "less than", "le": "at most"}[word]
        return f"{shown}, expected {phrase} {bound:g}"
    if kind == "float_type" and _is_number(line["input"]):
        return f"{shown}, expected a number; YAML wants a point and a sign in it, as in 1.0e-9"
    return f"{shown}, {_PLAIN.get(kind, line['msg'])}"


def _expected(root: type[Spec], location: tuple[str | int, ...]) -> str:
    for outer in specs_at(root, location[:-1]):
        field = keys(outer).get(str(location[-1]))
        if field is None:
            continue
        for annotation in field.metadata:
            if isinstance(annotation, Quantity):
                return annotation.expected
        if typing.get_origin(field.annotation) is typing.Literal:
            return " or ".join(map(str, typing.get_args(field.annotation)))
        text = next(
            descriptions(outer).get(name)
            for name, known in outer.model_fields.items()
            if known is field
        )
        if text:
            return re.split(r"[.;:]", text)[0].lower()
    return "a value"


def _is_number(value: Any) -> bool:
    """Whether a value is the text of a number, such as 1e-9, which is none to YAML 1.1."""
    try:
        float(value)
    except (TypeError, ValueError):
        return False
    return isinstance(value, str)

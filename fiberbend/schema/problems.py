"""What is wrong with a case: one line per problem, each with the path of the value."""

from __future__ import annotations

import dataclasses
import json
import re
import typing
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from pydantic import ValidationError

from fiberbend.schema.quantities import Model, Quantity

_PLAIN = {
    "model_type": "expected a mapping",
    "dict_type": "expected a mapping",
    "tuple_type": "expected a list",
    "too_short": "expected at least one entry",
    "string_type": "expected text",
    "bool_type": "expected true or false",
    "int_type": "expected a whole number",
    "float_type": "expected a number",
    "finite_number": "expected a finite number",
}


@dataclasses.dataclass(frozen=True)
class Problem:
    """One thing that is wrong.

    Attributes:
        path: dotted path in the case, or the name of a file.
        text: the rest of the line: what was found, what was expected.
    """

    path: str
    text: str

    def __str__(self) -> str:
        """The line that a user reads."""
        return f"{self.path}: {self.text}"


class CaseError(Exception):
    """A case, a command or a run folder that cannot be used; nothing has been computed.

    Attributes:
        problems: what is wrong, at least one.
    """

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(map(str, self.problems)))

    def __reduce__(self) -> Any:
        """Pickles by its problems, so that MPI can hand it to the other ranks."""
        return CaseError, (self.problems,)


def found(value: Any) -> str:
    """A value as a message shows it: short, text in quotes."""
    if value is None:
        return "nothing"
    text = json.dumps(value, default=str, ensure_ascii=False)
    return text if len(text) <= 60 else text[:57] + "..."


def from_pydantic(error: ValidationError, root: type[Model]) -> Iterator[Problem]:
    """The problems that pydantic found.

    Args:
        error: what pydantic raised.
        root: the model that it was validating.
    """
    for line in error.errors(include_url=False):
        yield Problem(dotted(line["loc"]), _text(line, root))


def dotted(location: Iterable[str | int]) -> str:
    """A location as a path, `effects.1.winding.pitch`."""
    return ".".join(map(str, location)) or "case"


def _text(line: Any, root: type[Model]) -> str:
    kind, context = line["type"], line.get("ctx", {})
    if kind == "extra_forbidden":
        known = [key for model in _models_at(root, line["loc"][:-1]) for key in _keys(model)]
        return f"unknown key, expected one of {', '.join(known)}"
    if kind == "missing":
        return f"missing, expected {_expected(root, line['loc'])}"
    shown = found(line["input"])
    if kind == "literal_error":
        return f"{shown}, expected {context['expected'].replace(chr(39), '')}"
    if kind in ("greater_than", "greater_than_equal", "less_than", "less_than_equal"):
        ((word, bound),) = context.items()
        phrase = {"gt": "more than", "ge": "at least", "lt": "less than", "le": "at most"}[word]
        return f"{shown}, expected {phrase} {bound:g}"
    return f"{shown}, {_PLAIN.get(kind, line['msg'])}"


def _keys(model: type[Model]) -> Mapping[str, Any]:
    return {field.alias or name: field for name, field in model.model_fields.items()}


def _models_in(annotation: Any) -> Iterator[type[Model]]:
    if isinstance(annotation, type) and issubclass(annotation, Model):
        yield annotation
    for part in typing.get_args(annotation):
        yield from _models_in(part)


def _models_at(root: type[Model], location: Iterable[str | int]) -> list[type[Model]]:
    models = [root]
    for part in location:
        if isinstance(part, str):
            models = [
                inner
                for model in models
                if part in _keys(model)
                for inner in _models_in(_keys(model)[part].annotation)
            ]
    return models


def _expected(root: type[Model], location: tuple[str | int, ...]) -> str:
    for model in _models_at(root, location[:-1]):
        field = _keys(model).get(str(location[-1]))
        if field is None:
            continue
        for annotation in field.metadata:
            if isinstance(annotation, Quantity):
                return annotation.expected
        if typing.get_origin(field.annotation) is typing.Literal:
            return " or ".join(map(str, typing.get_args(field.annotation)))
        if field.description:
            return re.split(r"[.;:]", field.description)[0].lower()
    return "a value"

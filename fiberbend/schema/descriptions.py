"""What the fields of a case mean: the text that stands below each in its class."""

from __future__ import annotations

import ast
import functools
import inspect
import textwrap

from pydantic import BaseModel


@functools.cache
def descriptions(spec: type[BaseModel]) -> dict[str, str]:
    """Text below each field of a class and of those that it is made from, by the field's name.

    Read from the source when somebody asks: pydantic would read all of them at every start.
    """
    found: dict[str, str] = {}
    for base in reversed(spec.__mro__):
        if issubclass(base, BaseModel) and base.__module__.partition(".")[0] != "pydantic":
            found |= _own(base)
    return {name: text for name, text in found.items() if name in spec.model_fields}


def _own(spec: type[BaseModel]) -> dict[str, str]:
    try:
        source = inspect.getsource(spec)
    except (OSError, TypeError):
        # made by `create_model`: its fields have no text
        return {}
    (definition,) = ast.parse(textwrap.dedent(source)).body
    assert isinstance(definition, ast.ClassDef)
    found = {}
    for field, text in zip(definition.body, definition.body[1:], strict=False):
        if (
            isinstance(field, ast.AnnAssign)
            and isinstance(field.target, ast.Name)
            and isinstance(text, ast.Expr)
            and isinstance(text.value, ast.Constant)
            and isinstance(text.value.value, str)
        ):
            found[field.target.id] = inspect.cleandoc(text.value.value)
    return found

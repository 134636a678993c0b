"""Kernels as plain libraries: those of a scene in one, the same as each by itself."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import ufl

from fem import compat
from fem.libraries import Builder, together
from machine.folders import MachineError
from tests.fem.parts import sector


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder of kernels."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path


def powers(mesh: Any) -> list[Any]:
    """Functionals of a mesh."""
    x = ufl.SpatialCoordinate(mesh)
    return [(1.0 + x[0]) ** power * ufl.dx(mesh, degree=4) for power in (1, 2, 3)]


def test_forms_of_one_library_are_those_of_libraries_of_their_own(cache: Path) -> None:
    mesh = sector("hexahedron").mesh
    forms = powers(mesh)
    with together(forms):
        # in another order than that of the library
        found = [compat.compile_form(mesh, form) for form in reversed(forms)][::-1]
    assert len(list(cache.rglob("libffcx_forms*.so"))) == 1
    alone = [compat.compile_form(mesh, form) for form in forms]
    assert len(list(cache.rglob("libffcx_forms*.so"))) == 4
    values = [compat.assemble_scalar(form) for form in found]
    assert values == [compat.assemble_scalar(form) for form in alone]
    assert len(set(values)) == 3


def test_what_is_there_is_not_compiled_again(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = sector("hexahedron").mesh
    values, compiled = [], list[str]()
    for _ in range(2):
        forms = powers(mesh)
        with together(forms):
            values.append(compat.assemble_scalar(compat.compile_form(mesh, forms[1])))
        monkeypatch.setattr(Builder, "compile", lambda *_, **given: compiled.append(str(given)))
    assert values[0] == values[1]
    assert compiled == []


def test_a_compiler_that_fails_is_told_in_one_line(
    cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mesh = sector("hexahedron").mesh
    compat.compile_form(mesh, powers(mesh)[0])
    monkeypatch.setenv("CFLAGS", "-fno-such-thing")
    with pytest.raises(MachineError, match=r"^no kernel compiled in .*: compiler .*no-such-thing"):
        compat.compile_form(mesh, powers(mesh)[1])
    monkeypatch.delenv("CFLAGS")
    assert compat.assemble_scalar(compat.compile_form(mesh, powers(mesh)[1])) > 0

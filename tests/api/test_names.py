"""`import fiberbend`: quick, with its names, whatever else was imported."""

from __future__ import annotations

import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import fiberbend
from tests.conftest import ROOT

FUNCTIONS = ("load", "plan", "run", "sweep", "trial", "validate")


def test_names() -> None:
    assert set(FUNCTIONS) < {*fiberbend.__all__} <= {*dir(fiberbend)}
    assert [name for name in dir(fiberbend) if not name.startswith("_")] == sorted(
        name for name in fiberbend.__all__ if not name.startswith("_")
    )
    assert all(getattr(fiberbend, name) is not None for name in fiberbend.__all__)
    assert (Path(fiberbend.__file__).parent / "py.typed").exists()
    with pytest.raises(AttributeError, match="colour"):
        fiberbend.colour  # type: ignore[attr-defined]  # noqa: B018


@pytest.mark.parametrize("name", [*FUNCTIONS, "Result.mesh", "Result.at", "Result.report"])
def test_functions_are_documented_and_typed(name: str) -> None:
    function: object = fiberbend
    for part in name.split("."):
        function = getattr(function, part)
    assert callable(function)
    text = inspect.getdoc(function) or ""
    assert all(word in text for word in ("Args:", "Raises:"))
    signature = inspect.signature(function)
    assert signature.return_annotation is not inspect.Signature.empty
    for parameter in signature.parameters.values():
        assert parameter.kind is not parameter.VAR_KEYWORD, "swallows typos"
        if parameter.name != "self":
            assert f"{parameter.name}:" in text


def test_the_style_of_a_plot_is_public() -> None:
    style = inspect.signature(fiberbend.Result.plot).parameters["style"]
    assert style.annotation == "Style | None"
    assert fiberbend.Style("svg", width=85.0).inches[0] == pytest.approx(85 / 25.4)
    with pytest.raises(ValueError, match="format 'gif', expected png or svg or pdf"):
        fiberbend.Style("gif")  # type: ignore[arg-type]


def test_import_is_quick() -> None:
    """It loads nothing but itself: until the command takes the signals, Ctrl-C is a traceback."""
    script = "import sys; old = {*sys.modules}; import fiberbend; print(*({*sys.modules} - old))"
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert {name for name in done.stdout.split() if not name.startswith("fiberbend")} <= {
        "__future__"
    }


def test_folders_of_the_same_name_do_not_hide_the_functions() -> None:
    import fiberbend.plan.plan
    import fiberbend.sweep.command

    for name in ("plan", "sweep"):
        assert inspect.isfunction(getattr(fiberbend, name))
        assert inspect.ismodule(sys.modules[f"fiberbend.{name}"])


def test_plan_loads_nothing_slow() -> None:
    script = (
        "import sys, fiberbend\n"
        "print(fiberbend.plan('cases/section.yaml'))\n"
        "print(*[m for m in ('pandas', 'matplotlib', 'pyvista', 'mpi4py') if m in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True
    )
    *plan, modules = done.stdout.splitlines()
    assert plan[1].startswith("model:       section")
    assert modules == ""

"""What an effect costs that is not in the scene: docs/evidence/absent.md, `python bench/absent.py`.

The same case is solved where an effect is merely absent from it, and where the program never had
the effect: its line is taken out of the registry before that is read. Python's own count of calls,
of functions and of what is compiled, has no noise: the two must be equal.
"""

from __future__ import annotations

import argparse
import gc
import importlib.util
import json
import os
import re
import subprocess
import sys
import types
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "evidence" / "absent.md"
REGISTRY = "fiberbend.effects.table"
QUIET = ("output.pictures=false", "output.fields=false", "output.report=false")
SHORT = ("actuator.length=24 mm", "mesh.axial=8 mm", "mesh.section=1", "output.at_angles=[]")
TURNED = ("effects.0.pressure.angle=20 deg", "output.at_angles=[]")
CASES = {
    "section": ("cases/section.yaml", "mesh.section=1", *TURNED),
    "cell": ("cases/cell.yaml", "mesh.section=1", *TURNED),
    "body": ("cases/free_bending_smeared.yaml", *SHORT, "effects.0.pressure.to=10 kPa"),
}
"""A case of each model, small: what is called does not depend on its size."""


def unregister(effects: Iterable[str]) -> None:
    """Load the registry without some effects, as if nobody had written them.

    Args:
        effects: their classes' names.
    """
    spec = importlib.util.find_spec(REGISTRY)
    assert spec is not None
    assert spec.origin is not None
    text = Path(spec.origin).read_text(encoding="utf-8")
    for name in effects:
        text, found = re.subn(rf"^(from \S+ import {name}|        {name},)\n", "", text, flags=re.M)
        if found != 2:
            raise ValueError(f"{name} is not registered by an import and a line")
    module = types.ModuleType(REGISTRY)
    module.__file__ = spec.origin
    sys.modules[REGISTRY] = module
    exec(compile(text, spec.origin, "exec"), module.__dict__)


def count(case: str, settings: Iterable[str]) -> dict[str, int]:
    """Calls while a case is assembled and solved in this process, kernels compiled.

    Args:
        case: its file.
        settings: changes to it.

    Returns:
        Calls of Python functions and of compiled ones; unknowns, kernels, load steps, iterations.
    """
    from mpi4py import MPI

    from fiberbend.models.choice import meshed
    from fiberbend.reader.reader import read_case
    from fiberbend.running.assembly import assemble

    found = read_case(ROOT / case, list(settings))
    model = meshed(found)
    mesh = model.mesh(found)
    counts = {"call": 0, "c_call": 0}

    def see(_frame: types.FrameType, event: str, _argument: object) -> None:
        if event in counts:
            counts[event] += 1

    for profile in (None, see):
        # the first time imports and compiles
        gc.collect()
        gc.disable()  # whose calls come when it likes
        sys.setprofile(profile)
        try:
            built = assemble(found, mesh, MPI.COMM_SELF)
            report = built.march.run(built.ramps)
        finally:
            sys.setprofile(None)
            gc.enable()
    return {
        "calls": counts["call"],
        "compiled_calls": counts["c_call"],
        "unknowns": int(built.scene.body.size),
        "kernels": built.scene.kernels,
        "steps": report.steps,
        "iterations": report.iterations,
    }


def counted(case: str, settings: Iterable[str], without: Iterable[str] = ()) -> dict[str, int]:
    """`count` in a process of its own.

    Args:
        case: its file.
        settings: changes to it.
        without: classes of effects that the program does not have.
    """
    command = [sys.executable, str(Path(__file__).resolve()), "--case", case]
    command += [*(f"--set={item}" for item in settings), *(f"--without={item}" for item in without)]
    environment = os.environ | {"PYTHONPATH": str(ROOT), "PYTHONHASHSEED": "0"}
    done = subprocess.run(
        command, check=True, capture_output=True, text=True, env=environment, cwd=ROOT
    )
    found: dict[str, int] = json.loads(done.stdout.splitlines()[-1])
    return found


def absent_effects(case: str) -> list[str]:
    """Classes of all effects that a case does not list."""
    from fiberbend.effects.table import EFFECTS
    from fiberbend.reader.reader import read_case

    present = {effect.name for effect in read_case(ROOT / case).effects}
    return [effect.__name__ for name, effect in EFFECTS.items() if name not in present]


def main() -> None:
    """One count of a child, or the whole page."""
    options = argparse.ArgumentParser()
    options.add_argument("--case")
    options.add_argument("--set", action="append", default=[])
    options.add_argument("--without", action="append", default=[])
    given = options.parse_args()
    if given.case:
        unregister(given.without)
        print(json.dumps(count(given.case, given.set)))
        return
    lines = [
        "# An effect that is not in the scene",
        "",
        "Made by `python bench/absent.py`. The same case is solved twice: with effects that are "
        "merely absent from it, and by a program that never had them. Calls of Python functions "
        "and of compiled ones are counted from the assembly to the last load step; they have no "
        "noise.",
        "",
        "| model | effects never registered | calls: absent | never registered | compiled: absent "
        "| never registered | kernels |",
        "|---|---|---|---|---|---|---|",
    ]
    for model, (case, *settings) in CASES.items():
        names = absent_effects(case)
        one = counted(case, (*QUIET, *settings))
        other = counted(case, (*QUIET, *settings), names)
        lines.append(
            f"| {model} | {', '.join(name.removesuffix('Effect') for name in names)} "
            f"| {one['calls']} | {other['calls']} | {one['compiled_calls']} "
            f"| {other['compiled_calls']} | {one['kernels']} and {other['kernels']} |"
        )
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(PAGE.read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()

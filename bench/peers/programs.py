"""Each program on a mesh of the same actuator: prepare, run by itself, read what it found."""

from __future__ import annotations

import csv
import dataclasses
import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from bench.peers import calculix, scene
from bench.peers.arrays import Body, load_body
from bench.peers.record import GOALS, Record, Usage, run

ENVIRONMENT = scene.ROOT / "build" / "peers" / "felupe"
"""felupe's own environment; `make peers` makes it."""
PRESSURE = 0.1
"""In MPa; a little more than every program needs for the last goal."""
STEP = 0.005
"""Load step in MPa of the programs that take them fixed."""
_VERSION = re.compile(r"Version\s+(\S+)")


@dataclasses.dataclass(frozen=True)
class Rung:
    """A program on a mesh.

    Attributes:
        program: its name, one of `PROGRAMS`.
        section: elements through each thickness.
        axial: length of the elements, mm.
        limit: of its wall time, s.
        expected: seconds on an idle machine.
    """

    program: str
    section: int
    axial: float
    limit: float
    expected: float

    @property
    def name(self) -> str:
        """Of its files."""
        return f"{self.program}-{self.section}-{self.axial:g}"


def measured(rung: Rung, folder: Path) -> Record:
    """Run a program on a mesh in a new folder; its record."""
    folder.mkdir(parents=True, exist_ok=True)
    if not (folder / "body.npz").exists():
        scene.body_of(scene.meshed(rung.section, rung.axial)).save(folder / "body.npz")
    return PROGRAMS[rung.program](rung, folder, load_body(folder / "body.npz"))


def _ended(usage: Usage, limit: float, reason: str) -> str:
    """How a run came to its end; empty when all is well."""
    if usage.code is None:
        return f"time limit of {limit:g} s"
    return reason or (f"exit status {usage.code}" if usage.code else "")


def _left(path: Path) -> str:
    """What a run has left in a file that was not there before it."""
    return path.read_text(encoding="utf-8") if path.exists() else ""


def _fiberbend(rung: Rung, folder: Path, body: Body) -> Record:
    """fiberbend itself, after one run that compiles its kernels."""
    command = [sys.executable, "-m", "fiberbend", "run", str(scene.CASE), "--quiet", "--overwrite"]
    out = folder / "run"
    last = f"{GOALS[-1]:g} deg"
    goals = ", ".join(f'"{goal:g} deg"' for goal in GOALS)
    changes = [
        *scene.settings(rung.section, rung.axial),
        f"output.at_angles=[{goals}]",
        f'output.stop_at_angle="{last}"',
    ]
    command += ["--out", str(out), *(word for change in changes for word in ("--set", change))]
    root = {"PYTHONPATH": str(scene.ROOT)}
    warm = [*command, "--set", 'effects.0.pressure.to="0.1 kPa"']
    run(warm, folder, rung.limit, root, folder / "warm.log")
    usage = run(command, folder, rung.limit, root, folder / "run.log")
    if usage.code != 0:
        raise RuntimeError(f"fiberbend {_ended(usage, rung.limit, '')}: see {folder / 'run.log'}")
    rows = list(csv.DictReader((out / "history.csv").open(encoding="utf-8")))[1:]
    facts = json.loads((out / "run.json").read_text(encoding="utf-8"))
    done = np.cumsum([int(row["newton_iterations"] or 0) for row in rows])
    return Record(
        program=rung.program,
        version=facts["commit"][:9],
        section=rung.section,
        axial=rung.axial,
        elements=len(body.cells),
        unknowns=facts["unknowns"],
        kPa=[float(row["pressure_kPa"]) for row in rows],
        degrees=[float(row["angle_deg"]) for row in rows],
        done=done.tolist(),
        iterations=facts["newton_iterations"],
        wall=usage.wall,
        cpu=usage.cpu,
        memory=usage.memory,
        load=usage.load,
        ended="",
    )


def _calculix(rung: Rung, folder: Path, body: Body) -> Record:
    """CalculiX on fiberbend's .inp."""
    element = ELEMENTS[rung.program]
    calculix.prepare(rung.section, rung.axial, body, element, PRESSURE, folder)
    for ending in ("dat", "sta"):
        (folder / f"run.{ending}").unlink(missing_ok=True)
    usage = run(["ccx", "run"], folder, rung.limit, {}, folder / "run.log")
    pressures, angles = calculix.curve(body, _left(folder / "run.dat"), PRESSURE)
    increments = calculix.increments(_left(folder / "run.sta"))
    done = [count for kept, count in increments if kept]
    found = min(len(pressures), len(done))
    stopped = [line for line in _left(folder / "run.log").splitlines() if "*ERROR" in line]
    version = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False).stdout
    return Record(
        program=rung.program,
        version=(_VERSION.search(version) or ["", "?"])[1],
        section=rung.section,
        axial=rung.axial,
        elements=len(body.cells),
        unknowns=3 * int(calculix.labels(body).astype(bool).sum()),
        kPa=(1e3 * pressures[:found]).tolist(),
        degrees=np.degrees(angles[:found]).tolist(),
        done=done[:found],
        iterations=increments[-1][1] if increments else 0,
        wall=usage.wall,
        cpu=usage.cpu,
        memory=usage.memory,
        load=usage.load,
        ended=_ended(usage, rung.limit, stopped[0].split(":")[-1].strip() if stopped else ""),
    )


def _task(rung: Rung, folder: Path, pressure: float) -> Path:
    """What the scripts read."""
    task = {
        "mesh": str(folder / "mesh.msh"),
        "body": str(folder / "body.npz"),
        "rubbers": {n: (c1, c2, 2 * c1 * scene.BULK) for n, (c1, c2) in scene.YEOH.items()},
        "hoop": scene.hoop_stiffness(),
        "pressures": ELEMENTS.get(rung.program),
        "step": STEP,
        "pressure": pressure,
        "goal": GOALS[-1],
        "out": str(folder / "curve.jsonl"),
    }
    path = folder / "task.json"
    path.write_text(json.dumps(task), encoding="utf-8")
    return path


def _script(rung: Rung, folder: Path, body: Body, python: str, script: str, version: str) -> Record:
    """One of the scripts beside this file, whose lines are load steps."""
    curve = folder / "curve.jsonl"
    curve.unlink(missing_ok=True)
    usage = run(
        [python, str(Path(__file__).with_name(script)), str(_task(rung, folder, PRESSURE))],
        folder,
        rung.limit,
        {"PYTHONPATH": str(scene.ROOT)},
        folder / "run.log",
    )
    lines = [json.loads(line) for line in _left(curve).splitlines()]
    steps = [line for line in lines if "failed" not in line]
    done = np.cumsum([line["iterations"] for line in steps]).tolist()
    reason = "".join(line["failed"] for line in lines if "failed" in line)
    return Record(
        program=rung.program,
        version=version,
        section=rung.section,
        axial=rung.axial,
        elements=len(body.cells),
        unknowns=steps[0]["unknowns"] if steps else 0,
        kPa=[1e3 * line["MPa"] for line in steps],
        degrees=[line["degrees"] for line in steps],
        done=done,
        iterations=done[-1] if done else 0,
        wall=usage.wall,
        cpu=usage.cpu,
        memory=usage.memory,
        load=usage.load,
        ended=_ended(usage, rung.limit, reason),
    )


def _dolfinx(rung: Rung, folder: Path, body: Body) -> Record:
    """The plain script, after one run that compiles its forms."""
    import dolfinx

    from fiberbend.results.mesh_file import write_mesh_file

    write_mesh_file(scene.the_case(rung.section, rung.axial), folder / "mesh.msh", True)
    script = Path(__file__).with_name("plain_dolfinx.py")
    warm = [sys.executable, str(script), str(_task(rung, folder, 0.0))]
    run(warm, folder, rung.limit, {"PYTHONPATH": str(scene.ROOT)}, folder / "warm.log")
    return _script(rung, folder, body, sys.executable, script.name, dolfinx.__version__)


def _felupe(rung: Rung, folder: Path, body: Body) -> Record:
    """felupe in its own environment."""
    python = str(ENVIRONMENT / "bin" / "python")
    ask = [python, "-c", "import felupe; print(felupe.__version__)"]
    version = subprocess.run(ask, capture_output=True, text=True, check=True).stdout.strip()
    return _script(rung, folder, body, python, "felupe_peer.py", version)


ELEMENTS = {
    "calculix-c3d20r": "C3D20R",
    "calculix-c3d20": "C3D20",
    "dolfinx-taylor-hood": "Lagrange",
    "dolfinx-dpc1": "DPC",
}
"""What a program's name says of its elements: solids, or pressures."""

PROGRAMS: dict[str, Callable[[Rung, Path, Body], Record]] = {
    "fiberbend": _fiberbend,
    "calculix-c3d20r": _calculix,
    "calculix-c3d20": _calculix,
    "dolfinx-taylor-hood": _dolfinx,
    "dolfinx-dpc1": _dolfinx,
    "felupe": _felupe,
}

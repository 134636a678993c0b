"""The states that a run has kept in its folder, read one at a time."""

from __future__ import annotations

import dataclasses
import functools
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from fiberbend import columns as col
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.models.choice import choose_model
from fiberbend.results.folder import FIBERS, MESH, SNAPSHOTS, RunFolder
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.mesh.data import MeshData
from geometry.winding.segments import EmbeddedFibers
from machine.folders import DAMAGED

STEP = "step_"
"""Begins the labels of states that nobody has asked for by angle or pressure."""
LAST = "last"
"""Label of the last state, where nobody has asked for it."""
_ABOUT = "about"
REST = "rest"
"""Label of the state before any load."""


def step_label(step: int) -> str:
    """Label of a load step that nobody has asked for."""
    return f"{STEP}{step:04d}"


def write_fibers(folder: RunFolder, fibers: EmbeddedFibers, smeared: bool) -> None:
    """Leave the winding in a run folder, for who draws the run when it is done."""
    folder.write_arrays(FIBERS, smeared=np.array(smeared), **vars(fibers))


def read_fibers(path: Path) -> tuple[EmbeddedFibers | None, bool]:
    """The winding of a run folder, and whether it is smeared; None and False without one."""
    if not (path / FIBERS).exists():
        return None, False
    with np.load(path / FIBERS) as file:
        names = [field.name for field in dataclasses.fields(EmbeddedFibers)]
        found = {name: file[name] for name in names if name in file}
        # runs of earlier versions do not tell families apart
        found.setdefault("family", np.zeros_like(found["curve"]))
        return EmbeddedFibers(**found), bool(file["smeared"])


def write_snapshot(folder: RunFolder, shot: Snapshot) -> None:
    """Leave a state in a run folder: its arrays, and the rest as one text, quick to read."""
    entries = {key: value for key, value in vars(shot).items() if value is not None}
    arrays = {key: value for key, value in entries.items() if isinstance(value, np.ndarray)}
    about = {key: value for key, value in entries.items() if key not in arrays}
    text = json.dumps(about, default=float)
    folder.write_arrays(f"{SNAPSHOTS}/{shot.label}.npz", **arrays, **{_ABOUT: np.array(text)})


def read_snapshot(path: Path, say: Callable[[str], None]) -> Snapshot | None:
    """A state; None where its file is damaged.

    Args:
        path: the file.
        say: takes a line for the user where it is damaged.
    """
    try:
        with np.load(path) as file:
            entries = dict(file)
            about = json.loads(str(entries.pop(_ABOUT)))
    except DAMAGED:
        say(f"{path} is damaged: left out")
        return None
    return Snapshot(**{"fiber_force": None, **entries, **about})


def snapshot_paths(path: Path) -> list[Path]:
    """Files of the states of a run folder, sorted by name."""
    return sorted((path / SNAPSHOTS).glob("*.npz"))


@dataclasses.dataclass(frozen=True)
class Kept:
    """A state that is in a folder.

    Attributes:
        label: its name, `REST` at rest.
        step: number of the load step, 0 at rest.
        pressure_kpa: chamber pressure, kPa.
        angle_deg: bending angle, °.
        path: its file; None at rest, which has none.
    """

    label: str
    step: int
    pressure_kpa: float
    angle_deg: float
    path: Path | None

    @property
    def asked(self) -> bool:
        """It was asked for by angle or pressure, or is the last one."""
        return not self.label.startswith(STEP) and self.label != REST


class States:
    """All states of a run from rest on, in the order of its load steps.

    Args:
        path: the run folder.
        case: its case.
        rows: of its history.
        say: takes a line for the user where a file is damaged.

    Attributes:
        kept: what there is; the first is the state at rest.

    Raises:
        CaseError: the folder has no mesh: the run kept no states.
    """

    def __init__(
        self,
        path: Path,
        case: Case,
        rows: list[dict[str, Any]],
        say: Callable[[str], None] = print,
    ) -> None:
        self._path, self._case, self._say = path, case, say
        if not (path / MESH).exists():
            text = "contains no states, expected a run of section, cell or body"
            raise CaseError([Problem(str(path), text)])
        by_step = {int(row[col.STEP]): row for row in rows}
        found: dict[int, Kept] = {0: Kept(REST, 0, 0.0, 0.0, None)}
        for file in snapshot_paths(path):
            step = self._step(file)
            row = by_step.get(step)
            if row is None:
                continue
            state = Kept(file.stem, step, row[col.PRESSURE], row[col.ANGLE], file)
            there = found.get(step)
            if there is None or not there.asked:
                found[step] = state
        self.kept = tuple(found[step] for step in sorted(found))

    def __len__(self) -> int:
        return len(self.kept)

    def __iter__(self) -> Iterator[Snapshot]:
        for kept in self.kept:
            shot = self.read(kept)
            if shot is not None:
                yield shot

    @functools.cached_property
    def model_mesh(self) -> ModelMesh:
        """Mesh, materials and fibers: of a section or a cell those of its own frame."""
        mesh = MeshData.load(self._path / MESH)
        fibers, smeared = read_fibers(self._path)
        materials = convert.site(self._case).materials
        model = choose_model(self._case)[0]
        elements = model.elements()
        return ModelMesh(
            mesh=mesh,
            materials={name: materials[name] for name in mesh.regions},
            fibers=fibers,
            smeared=smeared,
            title=self._case.title,
            uniform=elements is not None and elements.repeats(self._case),
            families=convert.looks(self._case),
            carried=model.slender() is not None,
        )

    def read(self, kept: Kept) -> Snapshot | None:
        """A state, read from its file; None where that is damaged."""
        if kept.path is None:
            return at_rest(self.model_mesh)
        return read_snapshot(kept.path, self._say)

    def _step(self, file: Path) -> int:
        if file.stem.startswith(STEP):
            return int(file.stem.removeprefix(STEP))
        try:
            with np.load(file) as arrays:
                return int(json.loads(str(arrays[_ABOUT]))["step"])
        except DAMAGED:
            self._say(f"{file} is damaged: left out")
            return -1


def at_rest(model_mesh: ModelMesh) -> Snapshot:
    """The state before any load, free of stress: p = 0 with the isochoric invariants Ī1, Ī2."""
    mesh, fibers = model_mesh.mesh, model_mesh.fibers
    return Snapshot(
        label=REST,
        step=0,
        pressure_kpa=0.0,
        angle_deg=0.0,
        displacement=np.zeros_like(mesh.nodes),
        multiplier=np.zeros(mesh.cells.shape),
        fiber_force=None if fibers is None else np.zeros(len(fibers.cell)),
    )

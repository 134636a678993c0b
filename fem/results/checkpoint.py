"""A march's position by input numbers: independent of ranks, of the mesh order and of dolfinx."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from fem import compat
from fem.effects.embedded_fibers import FiberPotential
from fem.march.frames import Frames
from fem.march.position import Position
from fem.march.records import Report, State
from fem.scene import Scene
from geometry.mesh.data import reference_nodes

Floats = npt.NDArray[np.float64]


def _gather(comm: Any, index: npt.NDArray[np.int64], values: Floats) -> Floats | None:
    """Rows of all ranks by their global numbers, on rank 0."""
    parts = comm.gather((index, values))
    if parts is None:
        return None
    count = max((int(i.max()) + 1 for i, _ in parts if len(i)), default=0)
    total = np.zeros((count, *values.shape[1:]))
    for i, rows in parts:
        total[i] = rows
    return total


class Archive:
    """Moves states between ranks and arrays on rank 0.

    Args:
        scene: the compiled scene.
        frames: rod frames, to describe a state that was read back; None: not needed.

    Attributes:
        comm: communicator of the scene.
    """

    def __init__(self, scene: Scene, frames: Frames | None) -> None:
        self._scene = scene
        self._frames = frames
        self.comm = self._comm = scene.domain.comm
        owned = scene.domain.owned
        self._cells = scene.domain.cells[:owned]
        self._multiplier: compat.PointValues | None = None

    def pack(self, position: Position) -> dict[str, Any]:
        """A position as arrays, on rank 0; nothing elsewhere; collective."""
        states = [self._pack(state) for state in position.states]
        if self._comm.rank != 0:
            return {}
        rest = {
            field.name: getattr(position, field.name)
            for field in dataclasses.fields(position)
            if field.name != "states"
        }
        rest["report"] = dataclasses.asdict(position.report)
        arrays: dict[str, Any] = {"position": np.array(json.dumps(rest, default=float))}
        for number, state in enumerate(states):
            arrays |= {f"{number}|{name}": value for name, value in state.items()}
        return arrays

    def unpack(self, arrays: Mapping[str, Any]) -> Position:
        """A position from arrays that every rank holds; the scene is left in its last state.

        Raises:
            TypeError: an entry that no position has.
        """
        rest = json.loads(str(arrays["position"]))
        states: dict[int, dict[str, Any]] = {}
        for key, value in arrays.items():
            number, found, name = key.partition("|")
            if found:
                states.setdefault(int(number), {})[name] = value
        report = Report(**rest.pop("report"))
        return Position([self._unpack(states[i]) for i in sorted(states)], report=report, **rest)

    def _pack(self, state: State) -> dict[str, Any]:
        """A state as arrays on rank 0, whatever elsewhere; collective."""
        body = self._scene.body
        full = body.with_ghosts(state.w)
        arrays: dict[str, Any] = {}
        for name in body.names:
            values = full[body.dofs(name)[: self._scene.domain.owned]]
            arrays[f"field/{name}"] = _gather(self._comm, self._cells, values)
        for key, memory in state.discrete.items():
            index = self._scene.discrete[key].index
            for name, values in memory.items():
                arrays[f"discrete/{key}/{name}"] = _gather(self._comm, index, values)
        for name, value in state.scalars.items():
            arrays[f"scalar/{name}"] = value
        for name, value in state.measures.items():
            arrays[f"measure/{name}"] = value
        return arrays

    def _unpack(self, arrays: Mapping[str, Any]) -> State:
        """A state from arrays that every rank holds; the scene is left in that state."""
        scene, body = self._scene, self._scene.body
        full = np.zeros(body.local)
        owned = scene.domain.owned
        for name in body.names:
            full[body.dofs(name)[:owned]] = arrays[f"field/{name}"][self._cells]
        # without ghost cells every owned dof lies in a cell of this rank
        w = full[: body.owned].copy()
        scalars = _part(arrays, "scalar/")
        for name, value in scalars.items():
            scene.set_scalar(name, float(value))
        scene.set(w)
        discrete = {
            key: {
                name: np.asarray(values)[scene.discrete[key].index]
                for name, values in _part(arrays, f"discrete/{key}/").items()
            }
            for key in scene.discrete
        }
        return State(
            w=w,
            scalars={name: float(value) for name, value in scalars.items()},
            measures={k: float(v) for k, v in _part(arrays, "measure/").items()},
            shape=self._frames.fit(body.displacement()) if self._frames else None,
            discrete=discrete,
        )

    def displacement(self) -> Floats | None:
        """Displacement at the present state by input node, mm, (n, 3), on rank 0."""
        body = self._scene.body
        return _gather(self._comm, body.owned_nodes, body.displacement())

    def multiplier(self) -> Floats | None:
        """Pressure field at the nodes of every cell, MPa, (m, k), on rank 0."""
        scene = self._scene
        if scene.body.pressure_field is None:
            return None
        if self._multiplier is None:
            nodes = reference_nodes(scene.domain.data.cell_type)
            self._multiplier = compat.PointValues(scene.domain.mesh, scene.body.p, nodes)
        return _gather(self._comm, self._cells, self._multiplier()[..., 0])

    def fiber_force(self) -> Floats | None:
        """Present force of every fiber segment, N, on rank 0; None without fibers; collective."""
        for discrete in self._scene.discrete.values():
            if isinstance(discrete, FiberPotential) and discrete.thread:
                return _gather(self._comm, discrete.index, discrete.force)
        return None


def _part(arrays: Mapping[str, Any], prefix: str) -> dict[str, Any]:
    return {k.removeprefix(prefix): v for k, v in arrays.items() if k.startswith(prefix)}

"""What tests of pictures in space draw: small cases, and frames of an animation."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fiberbend.reader.reader import parse_case
from fiberbend.states.recovery import recover, split_nodes
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.mesh.data import Floats
from tests.run.conftest import small

WINDING = {"winding": {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar"}}


def case(**changes: Any) -> Any:
    """A small body with changes."""
    return parse_case(small(**changes))


def frames(scene: ModelMesh, states: list[Snapshot]) -> Iterator[tuple[Snapshot, Floats]]:
    """States with the strain at their cells."""
    nodes = split_nodes(scene.mesh)
    for state in states:
        yield state, recover(scene, state, nodes).log_strain[nodes.cells]

"""Where the nodes of a body in space are in any state."""

from __future__ import annotations

from fiberbend.results.space import Space
from fiberbend.states.bend import Bend, in_frame
from fiberbend.states.snapshot import Snapshot
from geometry.mesh.data import Floats, Ints, MeshData


class Places:
    """Positions of nodes in space at any step.

    Args:
        space: body and fibers in space.
    """

    def __init__(self, space: Space) -> None:
        self._space = space
        self.mesh: MeshData = space.model_mesh.mesh

    def at(self, state: Snapshot, nodes: Ints | None = None) -> Floats:
        """Positions in a state, (n, 3), mm.

        Args:
            state: of the model's own mesh.
            nodes: numbers in the mesh in space; all by default.
        """
        stack, base = self._space.stack, self._space.own.mesh
        some = slice(None) if nodes is None else nodes
        if stack is None:
            moved: Floats = self.mesh.nodes[some] + state.displacement[some]
            return moved
        position = in_frame(base.nodes, state.displacement)[stack.node[some]] * stack.sign[some]
        return Bend.of(state, base).place(position, self.mesh.nodes[some, 2])

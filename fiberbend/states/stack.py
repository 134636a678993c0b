"""Sections and slices of uniform bending put together to a body in space."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
from numpy.typing import NDArray

from fiberbend.states.bend import Bend, in_frame
from fiberbend.states.recovery import NodalFields, SplitNodes, split_nodes
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.bodies.extrude import extrude
from geometry.bodies.stations import slice_stations
from geometry.mesh.data import Floats, Ints, MeshData
from geometry.mesh.mirror import both_halves
from geometry.winding.segments import EmbeddedFibers

_MIRRORED = (1.0, 1.0, -1.0)
_TURNED = (-1.0, 1.0, -1.0)


@dataclasses.dataclass(frozen=True)
class Stack:
    """A body in space of which every part is an image of one section or slice.

    Attributes:
        model_mesh: mesh, materials and fibers of the body, n nodes and m hexahedra.
        node: node of the section or slice that each node stands for, (n,).
        sign: signs of the components in the turning frame there, (n, 3).
        mirror: True for the nodes in a mirror plane z = const, (n,).
        cell: cell that each cell stands for, (m,).
        order: places of its nodes in the node list of that cell, (m, 27).
        segment: fiber segment that each segment stands for, (segments,), or None.
    """

    model_mesh: ModelMesh
    node: Ints
    sign: Floats
    mirror: NDArray[np.bool_]
    cell: Ints
    order: Ints
    segment: Ints | None

    def snapshot(self, base: ModelMesh, state: Snapshot) -> Snapshot:
        """A state of the section or slice as one of the body in space.

        Args:
            base: the section or slice.
            state: its state.
        """
        mesh = self.model_mesh.mesh
        position = in_frame(base.mesh.nodes, state.displacement)[self.node] * self.sign
        force = state.fiber_force
        return Snapshot(
            label=state.label,
            step=state.step,
            pressure_kpa=state.pressure_kpa,
            angle_deg=state.angle_deg,
            displacement=Bend.of(state, base.mesh).place(position, mesh.nodes[:, 2]) - mesh.nodes,
            multiplier=self.at_cells(state.multiplier),
            fiber_force=None if force is None or self.segment is None else force[self.segment],
            remark=state.remark,
        )

    def fields(
        self, base: ModelMesh, nodes: SplitNodes, fields: NodalFields, state: Snapshot
    ) -> NodalFields:
        """Recovered fields of the section or slice as those of the body, stress turned with it.

        Args:
            base: the section or slice.
            nodes: `split_alike` of the section or slice.
            fields: its fields.
            state: its state.
        """
        copies = self._copies
        source = np.empty(len(copies.node), dtype=np.int64)
        source[copies.cells.ravel()] = nodes.cells[self.cell[:, None], self.order].ravel()
        bend, z = Bend.of(state, base.mesh), self.model_mesh.mesh.nodes[:, 2]
        rotation = bend.rotations(z) * self.sign[:, None, :]
        rotation = rotation[copies.node]
        stress = fields.cauchy[source]
        # one side alone leaves some of the shear that the other one takes away
        in_plane = self.mirror[copies.node]
        stress[in_plane, 2, :2] = stress[in_plane, :2, 2] = 0.0
        return NodalFields(
            jacobian=fields.jacobian[source],
            stretches=fields.stretches[source],
            cauchy=rotation @ stress @ rotation.swapaxes(1, 2),
            multiplier=fields.multiplier[source],
            volume_error=fields.volume_error[self.cell],
        )

    @functools.cached_property
    def _copies(self) -> SplitNodes:
        return split_nodes(self.model_mesh.mesh)

    def at_cells(self, values: Floats) -> Floats:
        """Values at the nodes of every cell of the body from those of the section or slice.

        Args:
            values: at its cells, (cells, k, ...).

        Returns:
            Array (m, 27, ...).
        """
        return values[self.cell[:, None], self.order]


def extruded(model_mesh: ModelMesh, length: float, number: int, turned: bool = False) -> Stack:
    """A section extruded along z.

    Args:
        model_mesh: of the section.
        length: of the body, mm.
        number: layers of hexahedra.
        turned: the other half of a half section is its image by half a turn about y, as under a
            single helix, and is added; by a mirror plane it is left to whoever draws.
    """
    section = model_mesh.mesh
    node, cell = np.arange(len(section.nodes)), np.arange(len(section.cells))
    sign, order = np.ones((len(node), 3)), np.tile(np.arange(9), (len(cell), 1))
    if turned:
        whole = both_halves(section)
        section, node, cell, order = whole.mesh, whole.node, whole.cell, whole.order
        sign = np.where(whole.image[:, None], _TURNED, 1.0)
    mesh = extrude(section, slice_stations(length, number))
    planes = 2 * number + 1
    return Stack(
        model_mesh=_solid(model_mesh, mesh, None),
        node=np.tile(node, planes),
        sign=np.tile(sign, (planes, 1)),
        mirror=np.zeros(len(mesh.nodes), dtype=bool),
        cell=np.tile(cell, number),
        order=np.tile(order, (number, 3)),
        segment=None,
    )


def repeated(model_mesh: ModelMesh, number: int) -> Stack:
    """Slices put together along z.

    Each is the mirror image of the one before where half of the section is modelled, else alike.

    Args:
        model_mesh: of the slice.
        number: slices.
    """
    slab = model_mesh.mesh
    section = root_section(slab)
    quads, nodes = len(section.cells), len(section.nodes)
    layers, extent = len(slab.cells) // quads, float(slab.nodes[-1, 2])
    mesh = extrude(section, slice_stations(number * extent, number * layers))

    tile, plane = np.divmod(np.arange(len(mesh.nodes)) // nodes, 2 * layers)
    flipped = slab.half & (tile % 2 == 1)
    plane = np.where(flipped, 2 * layers - plane, plane)
    sign = np.where(flipped[:, None], _MIRRORED, 1.0)
    tiles, cells = np.divmod(np.arange(len(mesh.cells)), len(slab.cells))
    cell = np.empty_like(cells)
    cell[_copy(slab, quads, tiles, cells)] = cells
    forward = np.arange(27)
    backward = forward.reshape(3, 9)[::-1].ravel()
    turned = slab.half & (tiles % 2 == 1)
    segment, fibers = None, None
    if model_mesh.lines is not None:
        segment, fibers = _segments(model_mesh, model_mesh.lines, quads, number)
    return Stack(
        model_mesh=_solid(model_mesh, mesh, fibers),
        node=plane * nodes + np.arange(len(mesh.nodes)) % nodes,
        sign=sign,
        mirror=slab.half & (plane % (2 * layers) == 0),
        cell=cell,
        order=np.where(turned[:, None], backward, forward),
        segment=segment,
    )


def split_alike(mesh: MeshData) -> SplitNodes:
    """`split_nodes` of a section or slice, the ends of a slice that goes on alike being one."""
    if mesh.half or mesh.cell_type == "quadrilateral":
        return split_nodes(mesh)
    last = len(mesh.nodes) - len(root_section(mesh).nodes)
    tied = np.where(mesh.cells >= last, mesh.cells - last, mesh.cells)
    return split_nodes(dataclasses.replace(mesh, cells=tied))


def root_section(slab: MeshData) -> MeshData:
    """The quadrilaterals of a slice's end z = 0; its nodes and cells are the first of the slice."""
    quads = len(slab.facets["section_root"])
    cells = slab.cells[:quads, :9]
    facets = {}
    for name, pairs in slab.facets.items():
        sides = pairs[(pairs[:, 0] < quads) & (pairs[:, 1] > 0) & (pairs[:, 1] < 5)]
        if len(sides):
            facets[name] = sides - [0, 1]
    return MeshData(
        cell_type="quadrilateral",
        nodes=slab.nodes[: int(cells.max()) + 1, :2],
        cells=cells,
        regions=slab.regions,
        cell_region=slab.cell_region[:quads],
        facets=facets,
        half=slab.half,
        points=slab.points,
    )


def _solid(model_mesh: ModelMesh, mesh: MeshData, fibers: EmbeddedFibers | None) -> ModelMesh:
    return dataclasses.replace(model_mesh, mesh=mesh, fibers=fibers, uniform=False)


def _copy(slab: MeshData, quads: int, tile: Ints, cell: Ints) -> Ints:
    """Numbers in the body of cells of the slice, in its copies of some numbers."""
    layers = len(slab.cells) // quads
    layer = cell // quads
    layer = np.where(slab.half & (tile % 2 == 1), layers - 1 - layer, layer)
    return (tile * layers + layer) * quads + cell % quads


def _segments(
    model_mesh: ModelMesh, fibers: EmbeddedFibers, quads: int, number: int
) -> tuple[Ints, EmbeddedFibers]:
    """Fiber segments in all copies of a slice, sorted by curve and z, and what each stands for.

    Copy k of a slice 0 ≤ z ≤ ℓ (mm) has z_k = kℓ + z, or, mirrored (odd k of a half section),
    z_k = kℓ + ℓ − z. In the mirrored cell the reference coordinate ζ becomes 1 − ζ and a tangent
    (a, b, c) becomes (a, b, −c); taken backward, so that it runs toward growing z again, it is
    (−a, −b, c) with its points in reverse. A right-handed helix becomes the left-handed one, and
    line j of the m of a ribbon line m − 1 − j: curve h m + j becomes (1 − h) m + m − 1 − j.

    Args:
        model_mesh: of the slice.
        fibers: its lines.
        quads: cells of a layer.
        number: copies.

    Returns:
        The segment of the slice that each one stands for, and the segments.
    """
    slab = model_mesh.mesh
    count, extent = len(fibers.cell), float(slab.nodes[-1, 2])
    tile, segment = np.repeat(np.arange(number), count), np.tile(np.arange(count), number)
    flipped = slab.half & (tile % 2 == 1)
    whole = EmbeddedFibers(
        **{field.name: getattr(fibers, field.name)[segment] for field in dataclasses.fields(fibers)}
    )
    flip = np.array([1.0, 1.0, -1.0])
    # a mirrored segment is reversed, so that all run toward growing z
    points = np.where(
        flipped[:, None, None], [0.0, 0.0, 1.0] + whole.points[:, ::-1] * flip, whole.points
    )
    tangents = np.where(flipped[:, None, None], -whole.tangents[:, ::-1] * flip, whole.tangents)
    lines = round(1 / float(fibers.share[0]))
    image = (1 - whole.curve // lines) * lines + lines - 1 - whole.curve % lines
    z = tile * extent + np.where(flipped, extent - whole.z, whole.z)
    curve = np.where(flipped, image, whole.curve)
    copies = dataclasses.replace(
        whole,
        cell=_copy(slab, quads, tile, whole.cell),
        points=points,
        tangents=tangents,
        weights=np.where(flipped[:, None], whole.weights[:, ::-1], whole.weights),
        curve=curve,
        z=z,
        family=np.where(flipped, model_mesh.images(whole.family), whole.family),
    )
    order = np.lexsort((z, curve))
    return segment[order], EmbeddedFibers(
        **{field.name: getattr(copies, field.name)[order] for field in dataclasses.fields(copies)}
    )

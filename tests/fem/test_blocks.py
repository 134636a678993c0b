"""Blocks of elements: how they are found, ordered and cut, and what comes of it on wide bodies."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import pytest
from mpi4py import MPI

from fem.scene import Scene
from fem.solver import dissection, factor
from fem.solver.dissection import Share
from fem.solver.fronts import Code
from fem.solver.layers import Layers
from fem.solver.order import blocks, pieces
from fem.solver.order.blocks import fronts_of, order_blocks
from fem.solver.order.constraints import Constraints
from fem.solver.order.graph import Graph, Tree, UnsuitableError
from fem.solver.order.pieces import WITHIN, Nodes, Section
from fem.solver.order.swept import find_elements
from fem.solver.rows import Rows
from tests.fem.layered import WIDE, tower
from tests.fem.test_layers import Bools, Floats, half_scene, inertia, stored

LAYERS = 10
"""Of a tower."""


def grid(counts: tuple[int, int, int], seed: int) -> tuple[Floats, Bools]:
    """Bricks beside, behind and upon each other."""
    return bricks(list(itertools.product(*map(range, counts))), seed)


def bricks(corners: Sequence[tuple[int, ...]], seed: int) -> tuple[Floats, Bools]:
    """Bricks of eight nodes with two unknowns within each and a constraint, unknowns shuffled."""
    rng = np.random.default_rng(seed)
    places = np.array(corners)[:, None] + list(itertools.product((0, 1), repeat=3))
    found, number = np.unique(places.reshape(-1, 3), axis=0, return_inverse=True)
    nodes, cells = len(found), len(corners)
    size = nodes + 3 * cells
    matrix = np.zeros((size, size))
    for cell, own in enumerate(number.reshape(cells, 8)):
        part = np.r_[own, nodes + 2 * cell, nodes + 2 * cell + 1]
        block = rng.standard_normal((len(part), len(part)))
        matrix[np.ix_(part, part)] += block @ block.T
        row, pressure = rng.standard_normal(len(part)), nodes + 2 * cells + cell
        matrix[pressure, part], matrix[part, pressure] = row, row
    order = rng.permutation(size)
    negative = np.arange(size) >= nodes + 2 * cells
    return matrix[np.ix_(order, order)], negative[order]


def graph_of(scene: Scene) -> tuple[Graph, Constraints]:
    """Graph and constraints of its tangent."""
    rows = Rows(scene.matrix)
    graph = rows.graph(Code(MPI.COMM_SELF), scene.volumetric)
    return graph, rows.constraints(graph, scene.volumetric)


def flat(across: int, thick: int) -> list[Nodes]:
    """A layer of a wall of bricks, a node to each corner and one within each brick."""
    found = [
        Nodes(frozenset([a * thick + b]), 7, 0)
        for a, b in itertools.product(range(across), range(thick))
    ]
    for a, b in itertools.product(range(across + 1), range(thick + 1)):
        around = itertools.product((a - 1, a), (b - 1, b))
        columns = [i * thick + j for i, j in around if 0 <= i < across and 0 <= j < thick]
        found.append(Nodes(frozenset(columns), 3, 3))
    return found


# --- elements ------------------------------------------------------------------------------------


def test_layers_are_those_of_the_mesh_in_the_caps_too() -> None:
    scene = half_scene(1.0)
    data = scene.body.domain.data
    swept = find_elements(graph_of(scene)[0])
    middles = data.nodes[data.cells].mean(axis=1)[:, 2].round(6)
    expected = np.unique(middles, return_counts=True)[1].tolist()
    found = np.bincount(swept.layer).tolist()
    assert found in (expected, expected[::-1])
    pairs = set(zip(swept.layer.tolist(), swept.column.tolist(), strict=True))
    assert len(pairs) == len(data.cells)


def test_columns_go_through_a_tower() -> None:
    swept = find_elements(graph_of(tower(MPI.COMM_SELF, columns=WIDE))[0])
    assert swept.column.max() + 1 == np.prod(WIDE)
    assert np.bincount(swept.layer).tolist() == [np.prod(WIDE)] * LAYERS


def test_what_belongs_to_no_element_is_refused() -> None:
    matrix, negative = grid((2, 2, 6), 1)
    alone = np.pad(matrix, (0, 1))
    node = int(np.flatnonzero(~negative)[0])
    alone[-1, -1] = alone[-1, node] = alone[node, -1] = 1.0
    rows, code = Rows(stored(alone)), Code(MPI.COMM_SELF)
    with pytest.raises(UnsuitableError, match="no element"):
        find_elements(rows.graph(code, np.r_[negative, False]))


# --- order ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(("length", "strips"), [(1, 1), (3, 1), (1, 3), (2, 2)])
def test_each_element_and_each_vertex_once_and_children_first(
    length: int, strips: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(blocks, "LENGTHS", (length,))
    monkeypatch.setattr(blocks, "STRIPS", (strips,))
    graph, constraints = graph_of(tower(MPI.COMM_SELF, columns=WIDE))
    swept = find_elements(graph)
    order = order_blocks(graph, swept)
    assert sorted(order.element) == list(range(len(swept.vertex)))
    assert order.block.max() + 1 == 2 * strips * -(-LAYERS // 2 // length)
    own, parent = constraints.settled(*fronts_of(graph, swept, order))
    coupled = np.flatnonzero(np.diff(graph.begin))
    assert sorted(np.concatenate(own)) == coupled.tolist()
    assert all(above > front for front, above in enumerate(parent[:-1]))
    assert parent[-1] == -1


def test_a_wide_wall_is_cut_both_ways_and_a_narrow_one_is_not() -> None:
    length, strips = blocks._best(Section(flat(18, 4)), 50)
    assert length > 1
    assert len(strips) > 1
    whole = blocks._seconds(Section(flat(18, 4)), 1, [frozenset(range(72))])
    assert blocks._seconds(Section(flat(18, 4)), length, strips) / length < 0.8 * whole
    assert len(blocks._best(Section(flat(2, 1)), 50)[1]) == 1


def test_a_piece_is_cut_into_all_its_elements() -> None:
    section = Section(flat(9, 3))
    columns = frozenset(range(6, 27))
    cut = section.cut(columns, 5)
    assert sorted(cut.order) == sorted(itertools.product(columns, range(5)))
    assert len(cut.depths) == len(cut.order) - 1
    # every depth but those of pieces occurs, and the first cut only once
    depths = [depth for depth in cut.depths if depth != WITHIN]
    assert depths.count(0) == 1
    assert set(depths) == set(range(max(depths) + 1))


def test_a_short_body_is_refused() -> None:
    matrix, negative = grid((3, 3, 3), 2)
    with pytest.raises(UnsuitableError, match="short"):
        Layers(stored(matrix), negative)


# --- solutions -----------------------------------------------------------------------------------


@pytest.mark.parametrize(("length", "strips"), [(1, 1), (3, 1), (1, 3), (2, 2)])
@pytest.mark.parametrize("leaf", [8, 60])
def test_solutions_and_inertia_are_those_of_dense_algebra(
    length: int, strips: int, leaf: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(blocks, "LENGTHS", (length,))
    monkeypatch.setattr(blocks, "STRIPS", (strips,))
    monkeypatch.setattr(pieces, "LEAF", leaf)
    monkeypatch.setattr(dissection, "GENERAL", 1.0)
    matrix, negative = grid((4, 2, 9), 3)
    b = np.random.default_rng(4).standard_normal((2, len(matrix)))
    unstable = matrix - np.diag(np.where(negative, 0.0, 4.0))
    for values in (matrix, unstable):
        layers = Layers(stored(values), negative)
        layers.renew()
        assert layers.negative_pivots == inertia(values)
        assert layers.solve(b) == pytest.approx(np.linalg.solve(values, b.T).T, rel=1e-7, abs=1e-8)
    assert inertia(unstable) > negative.sum()


def test_what_blocks_do_not_part_goes_plane_by_plane(monkeypatch: pytest.MonkeyPatch) -> None:
    # what lies within two elements
    monkeypatch.setattr(dissection, "GENERAL", 1.0)
    monkeypatch.setattr(blocks, "STRIPS", (3,))
    matrix, negative = grid((4, 2, 9), 5)
    within = np.flatnonzero(~negative & ((matrix[:, negative] != 0).sum(axis=1) == 1))
    row = next(i for i in within if matrix[within[0], i] == 0)
    matrix[within[0], row] = matrix[row, within[0]] = 1.0
    tried = list[bool]()
    plane_by_plane = dissection._plane_by_plane

    def noted(graph: Graph, constraints: Constraints, share: Share) -> Tree:
        tried.append(True)
        return plane_by_plane(graph, constraints, share)

    monkeypatch.setattr(dissection, "_plane_by_plane", noted)
    layers = Layers(stored(matrix), negative)
    assert tried
    layers.renew()
    assert layers.negative_pivots == inertia(matrix)
    b = np.ones((1, len(matrix)))
    assert np.linalg.norm(matrix @ layers.solve(b)[0] - 1) < 1e-8


@pytest.mark.parametrize("legs", [2, 4])
def test_an_end_that_falls_apart_goes_plane_by_plane(
    legs: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    # two legs, each a strip: the middle plane lies on three fronts
    monkeypatch.setattr(dissection, "GENERAL", 1.0)
    monkeypatch.setattr(blocks, "LENGTHS", (1,))
    monkeypatch.setattr(blocks, "STRIPS", (2,))
    trunk = list(itertools.product(range(4), range(2), range(2)))
    forked = trunk + list(itertools.product((0, 3), range(2), range(2, 2 + legs)))
    matrix, negative = bricks(forked, 7)
    rows, code = Rows(stored(matrix)), Code(MPI.COMM_SELF)
    graph = rows.graph(code, negative)
    swept = find_elements(graph)
    own, parent = fronts_of(graph, swept, order_blocks(graph, swept))
    assert parent.count(len(own) - 1) == 3
    assert dissection._block_by_block(graph, rows.constraints(graph, negative)) is None
    layers = Layers(stored(matrix), negative)
    layers.renew()
    assert layers.negative_pivots == inertia(matrix)
    b = np.ones((1, len(matrix)))
    assert np.linalg.norm(matrix @ layers.solve(b)[0] - 1) < 1e-8


def _solved(scene: Scene) -> tuple[Layers, npt.NDArray[np.float64]]:
    """In layers, and what MUMPS finds."""
    layers = Layers(scene.matrix, scene.volumetric)
    layers.renew()
    mumps = factor.Mumps(scene.matrix, volumetric=scene.volumetric, free=scene.free)
    mumps.renew()
    assert layers.negative_pivots == mumps.negative_pivots
    b, x = scene.matrix.createVecs()
    b.array_w[:] = np.where(scene.free, scene.residual()[0], 0.0)
    mumps.solve(b, x)
    theirs = x.array_r.copy()
    assert layers.solve(b.array_r[None])[0] == pytest.approx(
        theirs, rel=1e-6, abs=1e-8 * np.abs(theirs).max()
    )
    return layers, theirs


@pytest.mark.parametrize("leaf", [30, 60, 200])
def test_a_wide_tower_is_solved_as_by_mumps(leaf: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dissection, "GENERAL", 1.0)
    monkeypatch.setattr(pieces, "LEAF", leaf)
    calm, _ = _solved(tower(MPI.COMM_SELF, columns=WIDE))
    assert calm.pivoted <= 1
    pressed, _ = _solved(tower(MPI.COMM_SELF, 0.2, columns=WIDE))
    assert pressed.negative_pivots > calm.negative_pivots


def test_constraints_that_meet_others_on_their_way_are_not_lost() -> None:
    # constraints 0 and 1, both of unknown 3 alone; unknown 2 is eliminated with the second
    begin, near = np.array([0, 1, 2, 2, 4], np.int32), np.array([3, 3, 0, 1], np.int32)
    negative, each = np.array([True, True, False, False]), np.ones(4, np.int32)
    graph = Graph(begin, near, np.arange(4, dtype=np.int32), each, negative)
    rows = (np.array([0, 1, 2, 2, 2], np.int32), np.array([3, 3], np.int32), np.ones(2))
    constraints = Constraints(rows, graph)
    own, parent = constraints.settled([np.array([0]), np.array([1, 2]), np.array([3])], [1, 2, -1])
    assert [sorted(some.tolist()) for some in own] == [[2], [0, 1, 3]]
    assert parent == [1, -1]


def test_constraints_of_closed_pieces_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dissection, "GENERAL", 1.0)
    scene = tower(MPI.COMM_SELF, columns=(5, 5))
    graph, constraints = graph_of(scene)
    swept = find_elements(graph)
    before = fronts_of(graph, swept, order_blocks(graph, swept))
    after = constraints.settled(*before)
    fewer = [
        graph.negative[vertices].sum() - graph.negative[settled].sum()
        for vertices, settled in zip(before[0], after[0], strict=True)
    ]
    assert max(fewer) > 0
    layers = Layers(scene.matrix, scene.volumetric)
    layers.renew()
    assert layers.pivoted <= 1
    # else pivots have to be looked for in front after front
    monkeypatch.setattr(Constraints, "settled", lambda self, own, parent: (own, parent))
    layers = Layers(scene.matrix, scene.volumetric)
    with contextlib.suppress(ZeroDivisionError):
        layers.renew()
        assert layers.pivoted > 10

"""Factorisation in layers against dense algebra, MUMPS, and itself on two ranks."""

from __future__ import annotations

import json

import numpy as np
import numpy.typing as npt
import pytest
from mpi4py import MPI
from petsc4py import PETSc

from fem.effects.chamber_pressure import ChamberPressure
from fem.effects.effect import Effect
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Clamp, Symmetry
from fem.kinematics.domain import Domain
from fem.scene import Scene
from fem.solver import dissection, factor, fronts
from fem.solver.dissection import UnsuitableError
from fem.solver.factor import Factor
from fem.solver.layers import InaccurateError, Layers
from geometry.bodies.extrude import hexahedral_body
from geometry.sections.size import MeshSize
from tests.conftest import MpiRun
from tests.fem.layered import measure, tower
from tests.fem.parts import SHORT, law, perturb, stub, winding

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

PLANE, INNER, PRESSURES, COUNT = 7, 90, 20, 8
"""Unknowns of a plane, between planes, constraints between planes, and number of planes."""


def chain(seed: int, definite: bool = True, shuffled: bool = True) -> tuple[Floats, Bools]:
    """A saddle-point matrix of many layers, unknowns shuffled or not, and its constraints."""
    rng = np.random.default_rng(seed)
    width = PLANE + INNER + PRESSURES
    size = COUNT * width + PLANE
    matrix = np.zeros((size, size))
    negative = np.zeros(size, dtype=bool)
    for layer in range(COUNT):
        start = layer * width
        negative[start + PLANE + INNER : start + width] = True
        inside = np.arange(start, start + width + PLANE)
        # two strips side by side that share the planes and a cut, so that there is what to halve
        inner = inside[PLANE : PLANE + INNER]
        pressures = inside[PLANE + INNER : width]
        planes = np.r_[inside[:PLANE], inside[width:]]
        for half in (slice(0, INNER // 2 + 5), slice(INNER // 2 - 5, INNER)):
            part = np.r_[planes, inner[half]]
            block = rng.standard_normal((len(part), len(part)))
            matrix[np.ix_(part, part)] += block @ block.T if definite else block + block.T
        for number, pressure in enumerate(pressures):
            half = slice(0, INNER // 2 - 5) if number % 2 else slice(INNER // 2 + 5, INNER)
            part = np.r_[planes, inner[half]]
            row = rng.standard_normal(len(part))
            matrix[pressure, part], matrix[part, pressure] = row, row
    order = rng.permutation(size) if shuffled else np.arange(size)
    return matrix[np.ix_(order, order)], negative[order]


def stored(matrix: Floats) -> PETSc.Mat:
    """Its upper triangle, as a tangent is stored; entries of the diagonal even where zero."""
    upper = np.triu(matrix != 0) | np.eye(len(matrix), dtype=bool)
    rows, columns = np.nonzero(upper)
    begin = np.r_[0, np.cumsum(np.bincount(rows, minlength=len(matrix)))].astype(np.int32)
    csr = (begin, columns.astype(np.int32), matrix[rows, columns])
    result = PETSc.Mat().createSBAIJ(len(matrix), 1, csr=csr, comm=MPI.COMM_SELF)
    result.assemble()
    return result


def inertia(matrix: Floats) -> int:
    return int((np.linalg.eigvalsh(matrix) < 0).sum())


@pytest.fixture
def _all_in_layers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(factor, "LAYERED", 0)


@pytest.mark.parametrize("definite", [True, False])
@pytest.mark.parametrize("part", [10_000, 40])
def test_solutions_and_inertia_are_those_of_dense_algebra(
    definite: bool, part: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dissection, "PART", part)
    matrix, negative = chain(1, definite)
    layers = Layers(stored(matrix), negative)
    layers.renew()
    assert layers.negative_pivots == inertia(matrix)
    assert (layers.pivoted == 0) == definite
    b = np.random.default_rng(2).standard_normal((3, len(matrix)))
    assert layers.solve(b) == pytest.approx(np.linalg.solve(matrix, b.T).T, rel=1e-7, abs=1e-9)


def test_values_may_change_sign_between_factorisations() -> None:
    matrix, negative = chain(3)
    petsc = stored(matrix)
    layers = Layers(petsc, negative)
    layers.renew()
    before = layers.negative_pivots
    values = np.linalg.eigvalsh(matrix[np.ix_(~negative, ~negative)])
    shift = float(np.median(values))
    for row in np.flatnonzero(~negative):
        petsc.setValue(int(row), int(row), matrix[row, row] - shift)
    petsc.assemble()
    shifted = matrix - np.diag(np.where(negative, 0.0, shift))
    layers.renew()
    assert layers.negative_pivots == inertia(shifted)
    assert before == inertia(matrix) == negative.sum()
    b = np.ones((1, len(matrix)))
    assert np.linalg.norm(shifted @ layers.solve(b)[0] - 1) < 1e-8


@pytest.mark.usefixtures("_all_in_layers")
def test_a_singular_front_is_left_to_mumps_and_said() -> None:
    # two unknowns between planes that meet nothing but a plane: pivots come only with that
    matrix, negative = chain(4)
    size = len(matrix)
    whole = np.zeros((size + 2, size + 2))
    whole[:size, :size] = matrix
    plane = np.flatnonzero((matrix != 0).sum(axis=1) == (matrix != 0).sum(axis=1).max())[:2]
    whole[size, plane[0]] = whole[plane[0], size] = 1.0
    whole[size + 1, plane[1]] = whole[plane[1], size + 1] = 1.0
    free = np.ones(size + 2, dtype=bool)
    petsc = stored(whole)
    kept = Factor(petsc, volumetric=np.r_[negative, False, False], free=free)
    kept.renew()
    b = np.random.default_rng(5).standard_normal(size + 2)
    (x,) = kept.solve_many([b])
    assert np.linalg.norm(whole @ x - b) < 1e-9 * np.linalg.norm(b)
    assert kept.negative_pivots == inertia(whole)
    assert "singular" in kept.left


@pytest.mark.parametrize("pivot", [1e-6, 1e-10, 1e-15])
def test_small_pivots_are_refined_or_refused(pivot: float) -> None:
    matrix, negative = chain(6)
    size = len(matrix)
    whole = np.zeros((size + 1, size + 1))
    whole[:size, :size] = matrix
    plane = int(np.argmax((matrix != 0).sum(axis=1)))
    whole[size, plane] = whole[plane, size] = 1.0
    whole[size, size] = pivot
    layers = Layers(stored(whole), np.r_[negative, False])
    layers.renew()
    b = np.random.default_rng(7).standard_normal((1, size + 1))
    try:
        x = layers.solve(b)
    except InaccurateError:
        assert pivot < 1e-8
    else:
        assert np.linalg.norm(whole @ x[0] - b[0]) < 1e-9 * np.linalg.norm(b)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_no_number_is_refused_and_leaves_nothing_behind(bad: float) -> None:
    matrix, negative = chain(8)
    petsc = stored(matrix)
    layers = Layers(petsc, negative)
    layers.renew()
    before = layers.solve(np.ones((1, len(matrix))))
    for row, column in np.argwhere(np.triu(matrix) != 0)[::9001]:
        petsc.setValue(int(row), int(column), bad)
        petsc.assemble()
        with pytest.raises(ZeroDivisionError):
            layers.renew()
        petsc.setValue(int(row), int(column), matrix[row, column])
    petsc.assemble()
    layers.renew()
    assert np.array_equal(layers.solve(np.ones((1, len(matrix)))), before)
    with pytest.raises(InaccurateError):
        layers.solve(np.full((1, len(matrix)), np.nan))


@pytest.mark.usefixtures("_all_in_layers")
def test_what_is_no_number_at_first_is_no_reason_to_leave_layers() -> None:
    matrix, negative = chain(8)
    petsc = stored(matrix)
    kept = Factor(petsc, volumetric=negative, free=np.ones(len(matrix), dtype=bool))
    row = int(np.flatnonzero(negative)[0])
    column = int(np.flatnonzero(matrix[row])[0])
    place = (min(row, column), max(row, column))
    petsc.setValue(*place, np.nan)
    petsc.assemble()
    with pytest.raises(ZeroDivisionError, match="no numbers"):
        kept.renew()
    petsc.setValue(*place, matrix[row, column])
    petsc.assemble()
    kept.renew()
    assert kept._layers is not None
    assert kept.negative_pivots == inertia(matrix)


def test_a_front_beyond_32_bits_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    matrix, negative = chain(9)
    largest = Layers(stored(matrix), negative)._fronts
    entries = int((largest.own.astype(np.int64) * largest.size).max())
    monkeypatch.setattr(fronts, "LARGEST", entries)
    Layers(stored(matrix), negative)
    monkeypatch.setattr(fronts, "LARGEST", entries - 1)
    with pytest.raises(UnsuitableError, match="a front is too large"):
        Layers(stored(matrix), negative)


def half_scene(axial: float) -> Scene:
    """Half an actuator, in a random state."""
    return _assembled(
        Domain(hexahedral_body(SHORT, MeshSize(axial=axial, section=1, half=True))),
        [Symmetry(halves=True)],
    )


def scene_of(half: bool, cell: str = "hexahedron") -> Scene:
    """An actuator with everything that a body's tangent has, in a random state."""
    if half:
        return half_scene(3.0)
    domain = stub(cell)
    return _assembled(domain, [winding(domain, 0.38)])


def _assembled(domain: Domain, extra: list[Effect]) -> Scene:
    regions = list(domain.data.regions)
    scene = Scene(
        domain, [law("yeoh", regions), Incompressible(), ChamberPressure(), Clamp(), *extra]
    )
    perturb(scene, 0.02, 8)
    scene.assemble_tangent()
    return scene


@pytest.mark.usefixtures("_all_in_layers")
@pytest.mark.parametrize("half", [True, False])
def test_a_body_is_solved_as_by_mumps(half: bool) -> None:
    scene = scene_of(half)
    free = scene.free[: scene.body.owned]
    kept = Factor(scene.matrix, volumetric=scene.volumetric, free=free)
    other = factor.Mumps(scene.matrix, volumetric=scene.volumetric, free=free)
    columns = [scene.load("pressure"), np.where(free, scene.residual()[0], 0.0)]
    for opposite in (False, True) if half else (False,):
        scene.assemble_tangent(opposite)
        kept.renew()
        other.renew()
        assert not kept.left
        assert kept.negative_pivots == other.negative_pivots
        for mine, theirs in zip(kept.solve_many(columns), other.solve_many(columns), strict=True):
            assert mine == pytest.approx(theirs, rel=1e-6, abs=1e-8 * np.abs(theirs).max())


def test_what_is_no_long_body_is_left_to_mumps() -> None:
    scene = scene_of(False, "tetrahedron")
    with pytest.raises(UnsuitableError, match="constraints"):
        Layers(scene.matrix, scene.volumetric)
    # one block: every plane couples with every other
    dense = np.eye(30) + 1.0
    with pytest.raises(UnsuitableError):
        Layers(stored(dense), np.zeros(30, dtype=bool))


def test_an_unstable_tower_has_more_negative_pivots() -> None:
    calm, pressed = tower(MPI.COMM_SELF), tower(MPI.COMM_SELF, 0.2)
    counts = []
    for scene in (calm, pressed):
        layers = Layers(scene.matrix, scene.volumetric)
        layers.renew()
        mumps = factor.Mumps(scene.matrix, volumetric=scene.volumetric, free=scene.free)
        mumps.renew()
        assert layers.negative_pivots == mumps.negative_pivots
        counts.append(layers.negative_pivots)
    assert counts[1] > counts[0]


@pytest.mark.long
@pytest.mark.mpi
def test_two_ranks_equal_one(mpirun: MpiRun) -> None:
    run = mpirun(2, ["-m", "tests.fem.layered"])
    assert run.returncode == 0, run.stderr
    found = json.loads(run.stdout.splitlines()[-1])
    for name, value in measure(MPI.COMM_SELF).items():
        assert found[name] == pytest.approx(value, rel=1e-8), name


@pytest.mark.mpi
def test_two_ranks_may_have_any_rows(mpirun: MpiRun) -> None:
    run = mpirun(2, ["-m", "tests.fem.shared_chain"])
    assert run.returncode == 0, run.stderr
    found = json.loads(run.stdout)
    assert "not known" in found.pop("unknown")
    assert found.pop("gathered") == [0.0] * 3
    assert len(found) == 8
    for name, values in found.items():
        assert values["error"] < 1e-8, name
        assert values["pivots"] == 0, name

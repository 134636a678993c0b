"""The iterative solver against the direct one, on several ranks, and where it refuses."""

from __future__ import annotations

import json

import numpy as np
import pytest
from mpi4py import MPI

from fem.kinematics.place import Place
from fem.scene import Scene
from fem.solver import slabs as module
from fem.solver.factor import Factor
from fem.solver.problem import RefusedError
from fem.solver.slab_parts import Cuts
from fem.solver.slabs import Slabs
from tests.conftest import MpiRun
from tests.fem.layered import tower
from tests.fem.slabbed import measure


def of(scene: Scene, slabs: int | None = None) -> Slabs:
    """Slabs of a scene whose tangent is assembled."""
    solver = Slabs(
        scene.matrix, scene.volumetric, scene.free[: scene.body.owned], scene.place, slabs
    )
    solver.renew()
    return solver


@pytest.mark.parametrize("pressure", [0.0, 0.2])
@pytest.mark.parametrize("slabs", [1, 2])
def test_the_same_answer_as_the_direct_solver(pressure: float, slabs: int) -> None:
    """A displacement block that is definite, and one that is not."""
    scene = tower(MPI.COMM_SELF, pressure)
    free = scene.free
    right = np.where(free, scene.residual()[0], 0.0)
    lot = np.where(free, np.random.default_rng(0).standard_normal(len(right)), 0.0)
    direct = Factor(scene.matrix, volumetric=scene.volumetric, free=free)
    direct.renew()
    solver = of(scene, slabs)
    assert solver.slabs == slabs
    for b in (right, lot):
        known, found = direct.solve_many([b])[0], solver.solve_many([b])[0]
        for part in (scene.volumetric, ~scene.volumetric):
            error = np.linalg.norm((found - known)[part])
            assert error < 1e-5 * np.linalg.norm(known[part])
        assert np.linalg.norm(found - known) > 0.0 or slabs == 1
    assert not solver.solve_many([np.zeros_like(right)])[0].any()


def test_the_coarse_system_is_what_keeps_iterations_few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the motions of whole slabs a bending body takes more of them."""
    scene = tower(MPI.COMM_SELF)
    b = np.where(scene.free, scene.residual()[0], 0.0)
    solver = of(scene)
    solver.solve_many([b])
    monkeypatch.setattr(solver, "_coarse", np.zeros_like(solver._coarse))
    before = solver.iterations
    solver.solve_many([b])
    assert before < solver.iterations - before <= 2 * before + 20


def test_the_matrix_of_motions_is_that_of_the_whole_matrix() -> None:
    """Its colours give what every pair of motions gives."""
    scene = tower(MPI.COMM_SELF)
    solver = of(scene)
    size = scene.body.owned
    motions = np.zeros((size, solver.slabs * 6))
    for k, (block, moves) in enumerate(zip(solver._blocks, solver._moves, strict=True)):
        motions[solver._wanted[block.at], 6 * k : 6 * k + 6] = moves
    products = np.array([solver._times(column) for column in motions.T]).T
    whole = motions.T @ products
    assert np.linalg.inv(solver._coarse) == pytest.approx(whole, abs=1e-8 * abs(whole).max())


def test_a_matrix_that_changes_is_factorised_anew() -> None:
    scene = tower(MPI.COMM_SELF)
    b = np.where(scene.free, scene.residual()[0], 0.0)
    solver = of(scene)
    before = solver.solve_many([b])[0]
    scene.matrix.scale(2.0)
    solver.renew()
    assert solver.solve_many([b])[0] == pytest.approx(before / 2, rel=1e-5, abs=1e-9)


def test_no_convergence_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = tower(MPI.COMM_SELF)
    solver = of(scene)
    monkeypatch.setattr(module, "MOST", 2)
    with pytest.raises(RefusedError, match="no convergence in 2 iterations: a residual of"):
        solver.solve_many([np.where(scene.free, scene.residual()[0], 0.0)])


def test_a_right_side_that_is_no_number_is_refused() -> None:
    scene = tower(MPI.COMM_SELF)
    with pytest.raises(RefusedError, match="a right side that is no number"):
        of(scene).solve_many([np.full(scene.body.owned, np.nan)])


def test_a_singular_slab_is_refused() -> None:
    scene = tower(MPI.COMM_SELF)
    scene.matrix.zeroEntries()
    scene.matrix.assemble()
    with pytest.raises(RefusedError, match=r"a slab by itself has no factor: MUMPS: INFOG"):
        of(scene)


def test_stability_is_not_told() -> None:
    solver = of(tower(MPI.COMM_SELF))
    assert not solver.counts
    with pytest.raises(RefusedError, match="not counted"):
        _ = solver.negative_pivots


@pytest.mark.parametrize("heavy", [0.5, 30.0])
@pytest.mark.parametrize(("layers", "slabs"), [(4, 1), (10, 2), (40, 10), (127, 16)])
def test_slabs_meet_their_neighbours_only(layers: int, slabs: int, heavy: float) -> None:
    """Also where nearly all unknowns lie at one end."""
    ends = np.arange(layers + 1.0)
    z = layers * np.random.default_rng(0).random(5000) ** heavy
    cuts = Cuts(ends, z, 1000 if slabs == 10 else slabs)
    assert cuts.slabs == slabs
    assert (cuts.low[2:] > cuts.high[:-2]).all()
    assert (cuts.strips[:, 0] < cuts.strips[:, 1]).all()
    assert cuts.owner.max(initial=0) < slabs


def test_rigid_motions_strain_nothing() -> None:
    """At rest; of a body that is clamped, in all elements away from the clamp."""
    scene = tower(MPI.COMM_SELF)
    scene.set(np.zeros(scene.body.owned))
    scene.assemble_tangent()
    found: Place = scene.place()
    solver = of(scene)
    pull = np.array([solver._times(column) for column in found.rigid.T]).T
    away = found.low > 4.0
    assert np.abs(pull[away]).max() < 1e-10 * np.abs(pull).max()
    assert (found.high >= found.low).all()
    assert (found.high > found.low).tolist() == scene.volumetric.tolist()


@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [2, pytest.param(3, marks=pytest.mark.long)])
def test_ranks_find_the_same(mpirun: MpiRun, ranks: int) -> None:
    """Three ranks for two slabs: one has none."""
    run = mpirun(ranks, ["-m", "tests.fem.slabbed"])
    assert run.returncode == 0, run.stderr
    found, alone = json.loads(run.stdout), measure(MPI.COMM_SELF)
    assert found.pop("slabs") == alone.pop("slabs") == 2
    for name, value in alone.items():
        assert found[name] == pytest.approx(value, rel=1e-5), name

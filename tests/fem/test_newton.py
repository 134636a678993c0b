"""Newton's method on a bending body: its order, its variants, its failures."""

from __future__ import annotations

import itertools
import types

import numpy as np
import pytest
from mpi4py import MPI

from fem.effects.incompressible import Incompressible
from fem.effects.supports import Symmetry
from fem.kinematics.domain import Domain
from fem.scene import Scene
from fem.solver.newton import INVERTED, Newton, Outcome, Settings, _Solve
from fem.solver.reuse import Reuse
from tests.exact.solids import box
from tests.fem.parts import Bender, Floats, bender, law, set_positions

PRESSURE = 0.004
"""MPa; the body turns by some 2°, enough for the fibers' geometric stiffness to matter."""


def _solve(hybrid: bool, pressure: float = PRESSURE) -> tuple[Bender, Outcome]:
    body = bender(settings=Settings(tolerance=1e-9, iterations=25, hybrid=hybrid, reuse=False))
    body.scene.set_scalar("pressure", pressure)
    body.scene.predict(None)
    outcome = body.newton.solve(body.scene.w.copy())
    assert outcome.converged, outcome.reason
    return body, outcome


@pytest.fixture(scope="module")
def plain() -> tuple[Bender, Outcome]:
    """The solution with the true tangent."""
    return _solve(hybrid=False)


def test_corrections_shrink_quadratically_with_the_true_tangent() -> None:
    # an inconsistent term of R or K would leave them linear
    body, _ = _solve(hybrid=False)
    scene, newton = body.scene, body.newton
    scene.set_scalar("pressure", 3 * PRESSURE)
    sizes = []
    for _ in range(6):
        scene.assemble_tangent()
        newton.factor.renew()
        r, _ = scene.residual()
        r[~scene.free[: scene.body.owned]] = 0.0
        step = newton.solve_linear(r)
        scene.set(scene.w - step)
        sizes.append(np.abs(step[scene.body.node_dofs]).max())
    # fibers 1e5 stiffer than rubber give large constants: 0.07 to 10 per mm are seen; round-off
    # ends it at 1e-13 mm
    for before, after in itertools.pairwise(sizes[2:]):
        assert after < max(100 * before**2, 1e-12)
    assert sizes[-1] < 1e-10


def test_predicted_fiber_force_changes_the_way_and_not_the_end() -> None:
    # at a pressure where it saves an iteration: 5 instead of 6
    body, plain = _solve(False, 5 * PRESSURE)
    other, hybrid = _solve(True, 5 * PRESSURE)
    assert hybrid.history[-1] != plain.history[-1]
    assert hybrid.iterations <= plain.iterations
    assert other.angle.value() == pytest.approx(body.angle.value(), rel=1e-7)
    found, exact = (b.scene.body.displacement() for b in (other, body))
    assert np.abs(found - exact).max() < 1e-7 * np.abs(exact).max()


class _Volume:
    """Side condition: the chamber's volume takes a value."""

    def __init__(self, body: Bender, target: float) -> None:
        self._scene, self._target = body.scene, target

    def value(self) -> float:
        return self._scene.conjugate("pressure") / self._target - 1

    def row(self) -> Floats:
        return -self._scene.load("pressure") / self._target

    def noise(self) -> float:
        return 0.0

    def lag(self) -> float:
        return 0.0

    def slope(self, scalar: str) -> float:
        return 0.0  # V does not depend on P


def test_a_bordered_system_finds_the_scalar(plain: tuple[Bender, Outcome]) -> None:
    # the pressure that belongs to a volume, from a wrong one
    body, _ = plain
    volume = body.scene.conjugate("pressure")
    w = body.scene.w.copy()
    body.scene.set_scalar("pressure", 0.7 * PRESSURE)
    outcome = body.newton.solve(0.95 * w, ["pressure"], [_Volume(body, volume)])
    assert outcome.converged, outcome.reason
    assert body.scene.scalar("pressure") == pytest.approx(PRESSURE, rel=1e-7)
    with pytest.raises(ValueError, match="side condition"):
        body.newton.solve(w, ["pressure"], [])


def test_inertia_counts_the_pressure_dofs(plain: tuple[Bender, Outcome]) -> None:
    # on a stable branch K has as many negative eigenvalues as there are constraints on the volume
    body, _ = plain
    body.scene.assemble_tangent()
    body.newton.factor.renew()
    assert body.newton.factor.negative_pivots == int(body.scene.volumetric.sum())


def test_an_inverted_start_is_refused() -> None:
    # det F <= 0 must not reach a logarithm or a root, and must not pass for converged
    body = bender()
    w = body.scene.w.copy()
    w[body.scene.body.node_dofs[:, 2]] = -1.5 * body.scene.domain.data.nodes[:, 2]
    outcome = body.newton.solve(w)
    assert not outcome.converged
    assert outcome.least_det_f < 0
    assert outcome.reason == INVERTED.format(outcome.least_det_f)


def _block() -> Scene:
    """A cube on three mirror planes, whose forces count from 1 N on."""
    domain = Domain(box((4.0, 4.0, 4.0), (1, 1, 1)), MPI.COMM_SELF)
    planes = {"left": 0, "front": 1, "bottom": 2}
    supports = [Symmetry(surface, component) for surface, component in planes.items()]
    scene = Scene(domain, [law("yeoh", ["solid"]), Incompressible(), *supports])
    scene.raise_force_floor(1.0)
    return scene


@pytest.mark.parametrize("factor", [1.01, 1 + 1e-7])
def test_a_volume_without_a_force_is_no_equilibrium(factor: float) -> None:
    # rubber of an isochoric law that is only dilated has no stress: volume alone tells
    scene = _block()
    set_positions(scene, factor * scene.domain.data.nodes)
    outcome = Newton(scene, MPI.COMM_SELF, Settings()).solve(scene.w.copy())
    assert outcome.converged, outcome.reason
    force, volume, _ = outcome.history[0]
    assert force < 1e-12
    # ∫ (J − 1) φ dX over ∫ φ dX
    assert volume == pytest.approx(factor**3 - 1, rel=1e-6)
    assert outcome.reason == ""
    assert outcome.iterations == len(outcome.history) - 1 > 0
    assert outcome.history[-1][1] <= Settings().tolerance
    assert np.abs(scene.body.displacement()).max() < 1e-7


def test_a_force_without_a_volume_is_no_equilibrium() -> None:
    # the other way round: a pressure that no boundary holds
    scene = _block()
    w = scene.w.copy()
    w[scene.volumetric] = 1e-3
    outcome = Newton(scene, MPI.COMM_SELF, Settings()).solve(w)
    assert outcome.converged, outcome.reason
    force, volume, _ = outcome.history[0]
    assert force > 1e-4
    assert volume < 1e-14
    assert np.abs(scene.w[scene.volumetric]).max() < 1e-8


@pytest.mark.parametrize(
    ("sizes", "iteration", "reason"),
    [
        # so many times the least, and large in itself
        ([1e-2, 1.0, 1.0, 1.0, 11.0], 4, "the residual grows"),
        ([1e-2, 1.0, 1.0, 1.0, 9.0], 4, ""),
        ([1e-6, 1e-3, 1e-3, 1e-3, 0.9], 4, ""),
        # the first few may
        ([1e-2, 1.0, 1.0, 11.0], 3, ""),
        ([1.0] * 12, 11, "no convergence in 11 iterations"),
        ([1.0] * 11, 10, ""),
        ([1.0, 1.0, np.nan], 2, "an element turned inside out (least det F -0.5)"),
    ],
)
def test_when_newton_gives_up(sizes: list[float], iteration: int, reason: str) -> None:
    # the residual of the volumes alone is as good as that of the forces
    solve = types.SimpleNamespace(
        history=[(1e-9, size, 0.0) if np.isfinite(size) else (size,) * 3 for size in sizes],
        newton=types.SimpleNamespace(settings=Settings()),
        problem=types.SimpleNamespace(force_noise=0.0),
        sides_met=True,
        reuse=types.SimpleNamespace(effort=iteration),
        scale=1.0,
        reason="",
        _not_a_number=lambda: INVERTED.format(-0.5),
    )
    found = _Solve.test(solve, None, iteration, ())  # type: ignore[arg-type]
    assert solve.reason == reason
    assert (found < 0) == bool(reason)
    assert found <= 0


@pytest.mark.parametrize("row", [(1e-7, 0, 0), (0, 1e-7, 0), (0, 0, 1e-7), (0, 0, 0)])
@pytest.mark.parametrize("noise", [0.0, 1e-6])
def test_each_residual_is_below_the_tolerance(row: tuple[float, ...], noise: float) -> None:
    # forces no finer than round-off: 1e-7 of 2 N is less than 1e-6 N
    solve = types.SimpleNamespace(
        history=[row],
        newton=types.SimpleNamespace(settings=Settings()),
        problem=types.SimpleNamespace(force_noise=noise),
        sides_met=row[2] == 0,
        reuse=types.SimpleNamespace(effort=1),
        scale=2.0,
    )
    found = _Solve.test(solve, None, 1, ())  # type: ignore[arg-type]
    small = (row[0] == 0 or noise > 0) and row[1] == row[2] == 0
    assert (found > 0) == small


@pytest.mark.parametrize(
    ("tangents", "sizes", "again"),
    [
        ([], [1.0, 1e-5], False),
        ([0], [1e-5], False),
        # a factor of the iterate before: near the solution, and fast
        ([1], [1.0, 1e-5], True),
        ([1], [1e-2, 1e-3], False),
        ([1], [1.0, 2e-3], False),
        ([1], [1e-3, 5e-4], False),
        # an older one: as long as it reduces tenfold
        ([0], [1.0, 1e-1 - 1e-9], True),
        ([0], [1.0, 1e-1 + 1e-9], False),
    ],
)
def test_a_factor_is_used_again_where_it_is_fast(
    tangents: list[int], sizes: list[float], again: bool
) -> None:
    # the greatest of the three residuals tells
    reuse = Reuse(MPI.COMM_SELF)
    reuse.tangents = list(tangents)
    assert reuse.renews([(0.0, s, s / 2) for s in sizes]) != again

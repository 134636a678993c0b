"""One factor for many steps: Anderson's acceleration, the mixed steps of fibers, and when to renew.

Algebra and derivatives on dense numbers, then a bending body.
"""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI

from fem.kinematics.uniform import CURVATURE, SIDE, STRETCH, TWIST
from fem.march.increments import next_size
from fem.march.records import Ramp, Rules
from fem.scene import Scene
from fem.solver.anderson import Anderson
from fem.solver.newton import Newton, Outcome, Settings
from fem.solver.reuse import POOR, Reuse
from tests.fem.parts import Bender, bender
from tests.fem.test_uniform import STENCIL, _Bordered, _scene

SIZE = 7
PRESSURE = 0.02
"""MPa; the body turns by some 9°."""


def _linear(depth: int, steps: int) -> tuple[list[np.ndarray], list[float], np.ndarray, np.ndarray]:
    """Accelerated steps x → x − K₀⁻¹(K x − b) from zero: iterates, sizes; K₀⁻¹K and K₀⁻¹b."""
    rng = np.random.default_rng(3)
    k = rng.normal(size=(SIZE, SIZE)) + 4 * np.eye(SIZE)
    old = k + 0.4 * rng.normal(size=k.shape)
    b = rng.normal(size=SIZE)
    pull, goal = np.linalg.solve(old, k), np.linalg.solve(old, b)
    anderson = Anderson(MPI.COMM_SELF, depth)
    x, iterates, sizes = np.zeros(SIZE), [], []
    for _ in range(steps):
        change = goal - pull @ x
        x, left = anderson.next(x + change, change)
        iterates.append(x)
        sizes.append(left)
    return iterates, sizes, pull, goal


def test_anderson_finds_what_the_krylov_space_has() -> None:
    # of a linear problem it is GMRES: the least residual over the space of the steps (Walker and
    # Ni 2011, SIAM J. Numer. Anal. 49, pp. 1715-1735)
    _, sizes, pull, goal = _linear(SIZE + 1, SIZE + 1)
    for m in range(SIZE + 1):
        space = [np.linalg.matrix_power(pull, j + 1) @ goal for j in range(m)]
        basis = np.linalg.qr(np.array(space).T)[0] if m else np.zeros((SIZE, 0))
        least = np.linalg.norm(goal - basis @ (basis.T @ goal))
        assert sizes[m] == pytest.approx(least, rel=1e-4, abs=1e-7)


def test_anderson_ends_after_as_many_steps_as_unknowns() -> None:
    iterates, _, pull, goal = _linear(SIZE + 1, SIZE + 1)
    assert iterates[-1] == pytest.approx(np.linalg.solve(pull, goal), rel=1e-6)
    # plain steps are far off, and a short memory is in between
    plain = np.zeros(SIZE)
    for _ in range(SIZE + 1):
        plain = plain + goal - pull @ plain
    short, _, _, _ = _linear(2, SIZE + 1)
    near, far = (np.linalg.norm(x - iterates[-1]) for x in (short[-1], plain))
    assert 1e-8 < near < 0.1 * far


def test_a_repeated_step_and_a_new_factor_are_no_trouble() -> None:
    anderson = Anderson(MPI.COMM_SELF)
    step = np.array([1.0, 2.0])
    for _ in range(3):
        found, left = anderson.next(step, step)
        assert found == pytest.approx(step)
        assert left == pytest.approx(np.linalg.norm(step), rel=1e-6)
    anderson.forget()
    assert anderson.next(step + step, step)[0] == pytest.approx(2 * step)


# --- the mixed steps of fibers -------------------------------------------------------------------


@pytest.mark.parametrize(("name", "model"), [("smeared", "section"), ("discrete", "cell")])
def test_what_a_step_lacks_is_the_unpredicted_force_along_the_turned_fibers(
    name: str, model: str
) -> None:
    # Σ ℓ (EA e − N)(b₀ − b₁), b = ∂e/∂x, for N = 0 and by differences of the strains
    problem = _Bordered(_scene(name, model, "free"))
    scene: Scene = problem.scene
    (fibers,) = scene.discrete.values()
    before, now = problem.start(1), problem.start(2)
    rng = np.random.default_rng(4)
    v = rng.uniform(-1, 1, len(now))
    v[: scene.body.owned] *= scene.free[: scene.body.owned]
    v[scene.body.owned :] *= [
        {CURVATURE: 1e-2, STRETCH: 0.1, SIDE: 1e-2, TWIST: 1e-2}[n] for n in problem.names
    ]

    def strain(x: np.ndarray) -> np.ndarray:
        problem.set(x)
        return fibers.strain.copy()  # type: ignore[attr-defined,no-any-return]

    def rate(x: np.ndarray) -> np.ndarray:
        h = 1e-4
        return sum(c * (strain(x + k * h * v) - strain(x - k * h * v)) for k, c in STENCIL) / h

    force = fibers.length * fibers.stiffness * strain(now)  # type: ignore[attr-defined]
    exact = float(force @ (rate(before) - rate(now)))
    problem.set(before)
    scene.assemble_tangent()
    problem.set(now)
    scene.predicted = np.zeros(len(fibers.index))
    lags = [scene.lag_along(key) for key in problem.names]
    found = float(scene.lag() @ v[: scene.body.owned] + v[scene.body.owned :] @ lags)
    assert found == pytest.approx(exact, rel=1e-6)
    # nothing where all force was predicted, and at the tangent's own state
    scene.predict(None)
    assert not scene.lag().any()
    scene.predicted = np.zeros(len(fibers.index))
    problem.set(before)
    assert not scene.lag().any()


def test_a_prediction_is_by_the_last_tangent() -> None:
    # N = EA (e₁ + b₀·δ): what the step has solved for
    problem = _Bordered(_scene("discrete", "cell", "in its plane"))
    (fibers,) = problem.scene.discrete.values()
    before, now = problem.start(1), problem.start(2)
    owned = problem.scene.body.owned
    v = np.where(problem.scene.free[:owned], 1e-6 * problem.start(5)[:owned], 0.0)
    strains = []
    for w in (before[:owned] + v, before[:owned] - v):
        problem.set(np.concatenate([w, before[owned:]]))
        strains.append(fibers.strain.copy())  # type: ignore[attr-defined]
    problem.set(before)
    problem.scene.assemble_tangent()
    problem.set(now)
    problem.scene.predict(v)
    expected = fibers.strain + (strains[0] - strains[1]) / 2  # type: ignore[attr-defined]
    assert problem.scene.predicted / fibers.stiffness == pytest.approx(  # type: ignore[attr-defined]
        expected, abs=1e-10
    )


# --- when a factor is renewed --------------------------------------------------------------------


def _steps(reuse: Reuse, sizes: list[float]) -> list[bool]:
    """Make steps of given sizes; which of them had a factor of their own."""
    fresh = []
    for number, size in enumerate(sizes):
        reuse.renews([(1.0, 0.0, 0.0)] * (number + 1))
        fresh.append(reuse.fresh)
        reuse.next(np.array([float(number)]), np.array([size]))
        reuse._anderson.forget()  # sizes as given
    return fresh


def test_one_factor_serves_while_its_steps_shrink() -> None:
    reuse = Reuse(MPI.COMM_SELF, spares=True)
    sizes = [(0.9 * POOR) ** k for k in range(6)]
    assert _steps(reuse, sizes) == [True] + 5 * [False]
    assert (reuse.solves, reuse.spared, reuse.effort) == (6, 5, 3.5)


def test_a_second_factor_follows_where_they_do_not_and_then_one_a_step() -> None:
    reuse = Reuse(MPI.COMM_SELF, spares=True)
    slow = 1.1 * POOR
    found = _steps(reuse, [1.0, slow, 1.0, 0.1, 0.1 * slow, 1.0, 1.0])
    assert found == [True, False, True, False, False, True, True]
    assert reuse.effort == 7 - 3 / 2
    # and one a step where that is asked for
    assert all(_steps(Reuse(MPI.COMM_SELF, allowed=False, spares=True), [1.0, 0.1, 0.01]))


def test_increments_go_by_the_effort() -> None:
    rules = Rules()
    spared = Outcome(True, 9, 1, "", [], 1.0, spared=8)
    assert spared.effort == 5.0
    assert next_size(1.0, spared, np.inf, rules) == rules.grow
    assert next_size(1.0, Outcome(True, 9, 9, "", [], 1.0), np.inf, rules) == rules.shrink


# --- a bending body ------------------------------------------------------------------------------


def _bent(large: int) -> tuple[Bender, Outcome]:
    body = bender(settings=Settings(large=large))
    body.scene.set_scalar("pressure", PRESSURE)
    body.scene.predict(None)
    outcome = body.newton.solve(body.scene.w.copy())
    assert outcome.converged, outcome.reason
    return body, outcome


def test_one_factor_finds_the_same_state() -> None:
    (body, usual), (other, spared) = (_bent(large) for large in (10**9, 0))
    assert spared.factorisations <= 2 < usual.factorisations
    assert (usual.spared, spared.spared) == (0, spared.iterations - spared.factorisations)
    assert other.angle.value() == pytest.approx(body.angle.value(), rel=1e-7)


def test_steps_that_let_stiff_fibers_turn_are_no_use(monkeypatch: pytest.MonkeyPatch) -> None:
    # what they strain too much acts along b, where the old factor is soft
    _, mixed = _bent(0)
    monkeypatch.setattr(Scene, "lag", lambda self: np.zeros(self.body.owned))
    _, plain = _bent(0)
    assert mixed.effort < plain.effort


def test_a_march_with_one_factor_a_step_is_the_same_march() -> None:
    reports, pressures = [], []
    for large in (10**9, 0):
        body = bender(Rules(first_turn=np.deg2rad(4.0)), Settings(large=large))
        reports.append(body.run([Ramp("pressure", 2 * PRESSURE, at=(np.deg2rad(12.0),))]))
        pressures.append([state.scalars["pressure"] for state in body.states])
    usual, spared = reports
    assert usual.status == spared.status == "converged"
    assert spared.factorisations == spared.steps == usual.steps < usual.factorisations
    (step, _), (other, _) = usual.hits[0], spared.hits[0]
    assert pressures[1][other] == pytest.approx(pressures[0][step], rel=1e-7)


def test_fibers_that_may_go_slack_have_a_factor_an_iterate() -> None:
    body = bender(settings=Settings(large=0))
    assert body.newton.spares
    body.scene.discrete["SmearedWinding"].mixed = False
    assert not Newton(body.scene, MPI.COMM_SELF, Settings(large=0)).spares

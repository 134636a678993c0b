"""Load stepping: ramps, adaptive increments, exact roll-back, requested outputs hit exactly."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from fem.border import Closure
from fem.frames import Frames, Shape
from fem.guide import Guide
from fem.newton import Newton, Outcome
from fem.program import Functional, Ramp, Report, Rules, State, measure
from fem.scene import Scene

Floats = npt.NDArray[np.float64]


class _Conjugate:
    """Closing equation: the conjugate of a scalar takes a value."""

    def __init__(self, scene: Scene, name: str, target: float) -> None:
        self._scene, self._name, self._target = scene, name, target
        self._scale = max(abs(target), 1e-30)

    def value(self) -> float:
        return (self._scene.conjugate(self._name) - self._target) / self._scale

    def row(self) -> Floats:
        return -self._scene.load(self._name) / self._scale

    def slope(self, scalar: str) -> float:
        return -self._scene.corner(self._name, scalar) / self._scale


class _Stationary:
    """Closing equation: the potential is stationary in a natural scalar."""

    def __init__(self, scene: Scene, name: str) -> None:
        self._scene, self._name = scene, name
        self._lever = scene.body.span / scene.body.size_of(name)

    @property
    def _scale(self) -> float:
        return self._scene.force_scale * self._lever

    def value(self) -> float:
        return -self._scene.conjugate(self._name) / self._scale

    def row(self) -> Floats:
        return self._scene.load(self._name) / self._scale

    def slope(self, scalar: str) -> float:
        return self._scene.corner(self._name, scalar) / self._scale


class _Target:
    """Closing equation: a functional takes a value."""

    def __init__(self, functional: Functional, target: float) -> None:
        self._functional, self._target = functional, target

    def value(self) -> float:
        return self._functional.value() - self._target

    def row(self) -> Floats:
        return self._functional.row()

    def slope(self, scalar: str) -> float:
        return self._functional.slope(scalar)


class March:
    """Drives a scene along its ramps.

    Args:
        scene: the problem, at rest.
        newton: solver of that problem.
        frames: rod frames for the predictor; None where the kinematics turns by itself.
        followed: functional that requests refer to (the bending angle), or None.
        rules: incrementation.
        on_step: called after every converged increment with the state and its outcome.
        warn: called with a line of text when an increment fails.
    """

    def __init__(
        self,
        scene: Scene,
        newton: Newton,
        frames: Frames | None,
        followed: Functional | None,
        rules: Rules,
        on_step: Callable[[State, Outcome], None],
        warn: Callable[[str], None],
    ) -> None:
        self.scene = scene
        self.newton = newton
        self.frames = frames
        self.followed = followed
        self.rules = rules
        self.on_step = on_step
        self.warn = warn
        self.guide: Guide | None = None
        """A cheaper model's shapes, from which the difference is extrapolated."""
        self._astray = False
        """The last increment failed: the next one does without the guide."""
        self.states: list[State] = []
        self.report = Report()
        self.ramp = 0
        """Number of the ramp under way."""
        self.increment: float | None = None
        """Increment of the driven quantity to try next; None at the start of a ramp."""

    # --- states --------------------------------------------------------------------------------

    def capture(self) -> State:
        """The present state of the scene."""
        scene = self.scene
        scalars = {name: scene.scalar(name) for name in scene.body.scalars}
        measures = {f"value {name}": value for name, value in scalars.items()}
        measures |= {f"conjugate {name}": scene.conjugate(name) for name in scalars}
        if self.followed is not None:
            measures["followed"] = self.followed.value()
        return State(
            w=scene.w.copy(),
            scalars=scalars,
            measures=measures,
            shape=self.frames.fit(scene.body.displacement()) if self.frames else None,
            discrete={key: item.state() for key, item in scene.discrete.items()},
        )

    def restore(self, state: State) -> None:
        """Put the scene back to a captured state, exactly."""
        for name, value in state.scalars.items():
            self.scene.set_scalar(name, value)
        self.scene.set(state.w)

    def _natural(self) -> list[_Stationary]:
        """One equation for each natural scalar."""
        return [_Stationary(self.scene, name) for name in self.scene.natural]

    def _tangent_state(self, scalar: str) -> State:
        """A neighbour of the last state along the linear response to a scalar."""
        base = self.states[-1]
        self.restore(base)
        for discrete in self.scene.discrete.values():
            discrete.predict(None)
        scene, body = self.scene, self.scene.body
        rate, natural = self.newton.response(scalar, scene.natural, self._natural())
        nodal = body.with_ghosts(rate)[body.node_dofs[body.owned_nodes]]
        top = float(np.max(np.abs(nodal), initial=0.0))
        largest = max(scene.domain.comm.allgather(top)) / body.span
        for name, value in natural.items():
            largest = max(largest, abs(value) / body.size_of(name))
        step = 1e-5 / max(largest, 1e-300)
        scene.set_scalar(scalar, base.scalars[scalar] + step)
        for name, value in natural.items():
            scene.set_scalar(name, base.scalars[name] + step * value)
        scene.set(base.w + step * rate)
        state = self.capture()
        self.restore(base)
        return state

    def _predict(self, abscissa: str, target: float, history: list[State]) -> Floats:
        """Set the scene to the extrapolated state and return its coefficients."""
        t = np.array([state.measures[abscissa] for state in history])
        weights = np.array(
            [np.prod([(target - b) / (a - b) for b in np.delete(t, i)]) for i, a in enumerate(t)]
        )
        body = self.scene.body
        for name in body.scalars:
            values = [state.scalars[name] for state in history]
            self.scene.set_scalar(name, float(weights @ values))
        self.scene.set(np.tensordot(weights, [state.w for state in history], axes=1))
        if self.frames is not None:
            shapes = [state.shape for state in history if state.shape is not None]
            shape = self.frames.extrapolate(shapes, weights, self._guides(abscissa, [*t, target]))
            body.set_displacement(self.frames.rebuild(shape))
            self.scene.set(self.scene.w.copy())
        for key, discrete in self.scene.discrete.items():
            discrete.extrapolate([state.discrete[key] for state in history], weights)
        return self.scene.w.copy()

    def _guides(self, abscissa: str, values: Sequence[float]) -> list[Shape] | None:
        """Shapes of the guide at the given values of what is driven; None where it has none."""
        if (
            self.guide is None
            or self._astray
            or not all(self.guide.covers(abscissa, v) for v in values)
        ):
            return None
        return [self.guide.shape(abscissa, v) for v in values]

    def _history(self, abscissa: str) -> list[State]:
        """The last states with distinct abscissae, at most three, oldest first."""
        chosen: list[State] = []
        for state in reversed(self.states):
            value = state.measures[abscissa]
            scale = 1e-9 * max(abs(value), 1e-30)
            if all(abs(value - other.measures[abscissa]) > scale for other in chosen):
                chosen.insert(0, state)
            if len(chosen) == 3:
                break
        return chosen

    # --- increments ----------------------------------------------------------------------------

    def _solve(self, ramp: Ramp, kind: str, target: float) -> Outcome:
        """Predict and solve one increment; kind is 'value', 'conjugate' or 'followed'."""
        abscissa = measure(kind, ramp.scalar)
        start = self._predict(abscissa, target, self._history(abscissa))
        unknown: list[str] = list(self.scene.natural)
        closures: list[Closure] = list(self._natural())
        if kind == "value":
            self.scene.set_scalar(ramp.scalar, target)
            return self.newton.solve(start, unknown, closures)
        if kind == "conjugate":
            closures.append(_Conjugate(self.scene, ramp.scalar, target))
        else:
            assert self.followed is not None
            closures.append(_Target(self.followed, target))
        return self.newton.solve(start, [*unknown, ramp.scalar], closures)

    def _guess(self, drive: str, target: float) -> float:
        """Extrapolated value of the followed functional where the increment would end."""
        history = self._history(drive)
        t = [state.measures[drive] for state in history]
        y = [state.measures["followed"] for state in history]
        return float(np.polynomial.Polynomial(_interpolate(t, y))(target - t[-1]))

    def start(self) -> None:
        """Capture the state at rest; without it nothing can be predicted."""
        self.scene.set(self.scene.w.copy())
        self.states = [self.capture()]

    def run(self, ramps: Sequence[Ramp]) -> Report:
        """March through all ramps in order, earlier loads held."""
        if not self.states:
            self.start()
        for ramp in ramps[self.ramp :]:
            if not self._ramp(ramp):
                break
            self.ramp += 1
            self.increment = None
        return self.report

    def _ramp(self, ramp: Ramp) -> bool:
        drive = ramp.key
        now = self.states[-1].measures[drive]
        span = ramp.target - now
        if span == 0:
            return True
        largest = abs(ramp.largest) if ramp.largest else np.inf
        sign = np.sign(span)
        if self.increment is None:
            seed = self._tangent_state(ramp.scalar)
            size = abs(ramp.first) if ramp.first else self._first_size(seed, drive, abs(span))
            self.states = [seed, self.states[-1]]
            self.increment = min(size, largest, abs(span))
        size = self.increment
        failures = 0
        insist = False
        pending, halts = sorted(ramp.at), ramp.stops
        if ramp.until is not None:
            pending = sorted({*(a for a in ramp.at if a < ramp.until), ramp.until})
        if ramp.drive == "followed":
            pending, halts = [], (*ramp.stops, *ramp.at)
        while True:
            state = self.states[-1]
            now = state.measures[drive]
            left = abs(ramp.target - now)
            if left <= 1e-9 * abs(span):
                return True
            stops = [s for s in (*halts, ramp.target) if sign * (s - now) > 1e-9 * abs(span)]
            nearest = min(stops, key=lambda s: abs(s - now))
            size = min(size, self._turn_limit(drive))
            target = now + sign * size
            if sign * (target - nearest) > -0.2 * size:
                target = nearest
            kind = ramp.drive
            goal = self._due(pending, state)
            close = goal is not None and (insist or self._guess(drive, target) > goal - 0.02)
            insist = False
            if goal is not None and close:
                kind, aim = "followed", goal
            else:
                aim = float(target)
            outcome = self._solve(ramp, kind, aim)
            self.report.iterations += outcome.iterations
            self.report.factorisations += outcome.factorisations
            accepted = outcome.converged
            overshot = False
            if accepted:
                new = self.capture()
                if goal is not None and kind != "followed":
                    overshot = insist = new.measures["followed"] > goal + 1e-9
                if kind != ramp.drive and sign * (new.measures[drive] - ramp.target) > 0:
                    # the angle lies beyond the load's end: go there by the load instead
                    pending = [a for a in pending if a < goal - 1e-12] if goal else []
                    overshot = True
            self._astray = not accepted
            if not accepted or overshot:
                self.restore(state)
                if overshot:
                    continue
                failures += 1
                self.report.cutbacks += 1
                self.warn(f"increment cut back: {outcome.reason}")
                if failures > self.rules.cutbacks:
                    self.report.status = "failed"
                    self.report.reason = outcome.reason
                    return False
                size *= self.rules.cut
                continue
            failures = 0
            self.states = [*self.states[-2:], new]
            self.report.steps += 1
            self.report.per_step.append(outcome.iterations)
            if outcome.iterations <= self.rules.easy:
                size = min(size * self.rules.grow, largest)
            elif outcome.iterations >= self.rules.slow:
                size *= self.rules.shrink
            self.increment = size
            self.on_step(new, outcome)
            if kind == "followed" and ramp.until is not None and aim >= ramp.until - 1e-9:
                return True

    def _turn_limit(self, drive: str) -> float:
        """Increment that turns the followed functional by `turn`, from the last two states."""
        if self.followed is None or len(self.states) < 3:
            return np.inf
        a, b = (state.measures for state in self.states[-2:])
        turned = abs(b["followed"] - a["followed"])
        return float(abs(b[drive] - a[drive]) * self.rules.turn / max(turned, 1e-12))

    def _due(self, pending: list[float], state: State) -> float | None:
        """The next requested value of the followed functional."""
        if self.followed is None:
            return None
        here = state.measures["followed"]
        return next((a for a in pending if a > here + 1e-9), None)

    def _first_size(self, seed: State, drive: str, span: float) -> float:
        """First increment: the linear response turns the followed functional by `first_turn`."""
        base = self.states[-1]
        if self.followed is None:
            return span / 20
        turned = seed.measures["followed"] - base.measures["followed"]
        driven = seed.measures[drive] - base.measures[drive]
        if abs(turned) < 1e-14 or abs(driven) < 1e-300:
            return span / 20
        return float(abs(driven / turned) * self.rules.first_turn)


def _interpolate(t: list[float], y: list[float]) -> Floats:
    """Coefficients in (x − t[-1]) of the polynomial through the points, lowest first."""
    x = np.array(t) - t[-1]
    scale = np.max(np.abs(x)) or 1.0
    powers = np.vander(x / scale, increasing=True)
    return np.linalg.solve(powers, np.array(y)) / scale ** np.arange(len(x))

"""Where an increment starts: earlier states extrapolated, rotations on their group."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from fem.march.frames import Frames, Shape
from fem.march.guide import Guide
from fem.march.records import State
from fem.scene import Scene

Floats = npt.NDArray[np.float64]

AMPLIFIED = 35.0
"""Sum of the sizes of weights up to which what a guide leaves over is a parabola. From rest, 15°
and 60° to 160° it is 48: the parabola points nowhere. A first growth by three makes 31, and
helps."""
TOGETHER = 1e-3
"""States this part of their range apart are a state and a slope: their weights count as one."""


class Predictor:
    """Puts a scene where its last states point to.

    Args:
        scene: the scene.
        frames: rod frames; None where the kinematics turns by itself.
        guide: a cheaper model's shapes, from which the difference is extrapolated; None: without.
    """

    def __init__(self, scene: Scene, frames: Frames | None, guide: Guide | None = None) -> None:
        self._scene, self._frames, self._guide = scene, frames, guide
        self._turning, self._astray, self._plain = True, False, False
        self._unguided = False

    def describe(self) -> Shape | None:
        """The scene's present displacement as a rod; None without frames."""
        return self._frames.fit(self._scene.body.displacement()) if self._frames else None

    def turned(self, shape: Shape | None) -> float | None:
        """Greatest turn of a rod, rad, where the bending angle does not tell it; else None."""
        return None if self._frames is None or shape is None else self._frames.turned(shape)

    def turn(self, turning: bool) -> None:
        """Extrapolate displacements in the frames that turn with the body, or as they are."""
        self._turning = turning

    def heed(self, failures: int, critical: bool) -> None:
        """Learn from how the last increment ended.

        After a failed one do without the guide, straight on from the last two states. Beyond a
        critical point a guide is on another branch, or beyond one of its own; and of a section that
        folds the frames may turn by leaps: after a failed one do without them too.

        Args:
            failures: increments that failed since the last one that did not.
            critical: stability was lost before.
        """
        self._unguided = self._unguided or critical
        self._astray = failures > 0
        self._plain = self._astray and self._unguided

    def start(self, states: Sequence[State], key: str, target: float) -> Floats:
        """Set the scene to the state extrapolated to the value of a measure; its coefficients.

        Args:
            states: to extrapolate from, with distinct values of the measure.
            key: name of the measure.
            target: its value.
        """
        states = states[-2:] if self._astray else states
        t = np.array([state.measures[key] for state in states])
        weights = lagrange(t, target)
        if self._guide is not None and amplification(t, weights) > AMPLIFIED:
            states, t = states[-2:], t[-2:]
            weights = lagrange(t, target)
        scene, body = self._scene, self._scene.body
        for name in body.scalars:
            values = np.array([state.scalars[name] for state in states])
            scene.set_scalar(name, extrapolated(weights, values))
        scene.set(np.tensordot(weights, [state.w for state in states], axes=1))
        if self._frames is not None and self._turning and not self._plain:
            shapes = [state.shape for state in states if state.shape is not None]
            guides = self._guides(key, [*t, target])
            shape = self._frames.extrapolate(shapes, weights, guides)
            body.set_displacement(self._frames.rebuild(shape))
            scene.set(scene.w.copy())
        scene.extrapolate([state.discrete for state in states], weights)
        return scene.w.copy()

    def _guides(self, key: str, values: Sequence[float]) -> list[Shape] | None:
        """Shapes of the guide at the given values of what is driven; None where it has none."""
        if (
            self._guide is None
            or self._astray
            or self._unguided
            or not all(self._guide.covers(key, value) for value in values)
        ):
            return None
        return [self._guide.shape(key, value) for value in values]


def lagrange(t: Floats, target: float) -> Floats:
    """Weights of values at t that give the value at the target."""
    return np.array(
        [np.prod([(target - b) / (a - b) for b in np.delete(t, i)]) for i, a in enumerate(t)]
    )


def amplification(t: Floats, weights: Floats) -> float:
    """By how much an extrapolation enlarges errors: Σ |w|, states close together taken as one."""
    order = np.argsort(t)
    apart = np.diff(t[order]) > TOGETHER * np.ptp(t)
    groups = np.concatenate([[0], np.cumsum(apart)])
    return float(np.abs(np.bincount(groups, weights[order])).sum())


def extrapolated(weights: Floats, values: Floats) -> float:
    """Weighted sum, the weights adding to 1: of equal values that value, to the last digit.

    A scalar that is kept, such as an earlier load, would else drift from step to step.
    """
    return float(values[-1] + weights @ (values - values[-1]))


def distinct(states: Sequence[State], key: str) -> list[State]:
    """Of states with the same value of a measure the last one; oldest first."""
    chosen: list[State] = []
    scale = 1e-9 * max(abs(state.measures[key]) for state in states)
    for state in reversed(states):
        value = state.measures[key]
        if all(abs(value - other.measures[key]) > scale for other in chosen):
            chosen.insert(0, state)
    return chosen

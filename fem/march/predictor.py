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


class Predictor:
    """Puts a scene where its last states point to.

    Args:
        scene: the scene.
        frames: rod frames; None where the kinematics turns by itself.

    Attributes:
        frames: rod frames, or None.
        guide: a cheaper model's shapes, from which the difference is extrapolated; None: without.
        astray: the last increment failed: the next one does without the guide, and goes straight
            on from the last two states.
    """

    def __init__(self, scene: Scene, frames: Frames | None) -> None:
        self._scene, self.frames = scene, frames
        self.guide: Guide | None = None
        self.astray = False

    def start(self, states: Sequence[State], key: str, target: float) -> Floats:
        """Set the scene to the state extrapolated to the value of a measure; its coefficients.

        Args:
            states: to extrapolate from, with distinct values of the measure.
            key: name of the measure.
            target: its value.
        """
        states = states[-2:] if self.astray else states
        t = np.array([state.measures[key] for state in states])
        weights = lagrange(t, target)
        scene, body = self._scene, self._scene.body
        for name in body.scalars:
            values = [state.scalars[name] for state in states]
            scene.set_scalar(name, float(weights @ values))
        scene.set(np.tensordot(weights, [state.w for state in states], axes=1))
        if self.frames is not None:
            shapes = [state.shape for state in states if state.shape is not None]
            guides = self._guides(key, [*t, target])
            shape = self.frames.extrapolate(shapes, weights, guides)
            body.set_displacement(self.frames.rebuild(shape))
            scene.set(scene.w.copy())
        for name, discrete in scene.discrete.items():
            discrete.extrapolate([state.discrete[name] for state in states], weights)
        return scene.w.copy()

    def _guides(self, key: str, values: Sequence[float]) -> list[Shape] | None:
        """Shapes of the guide at the given values of what is driven; None where it has none."""
        if (
            self.guide is None
            or self.astray
            or not all(self.guide.covers(key, value) for value in values)
        ):
            return None
        return [self.guide.shape(key, value) for value in values]


def lagrange(t: Floats, target: float) -> Floats:
    """Weights of values at t that give the value at the target."""
    return np.array(
        [np.prod([(target - b) / (a - b) for b in np.delete(t, i)]) for i, a in enumerate(t)]
    )


def distinct(states: Sequence[State], key: str) -> list[State]:
    """Of states with the same value of a measure the last one; oldest first."""
    chosen: list[State] = []
    for state in reversed(states):
        value = state.measures[key]
        scale = 1e-9 * max(abs(value), 1e-30)
        if all(abs(value - other.measures[key]) > scale for other in chosen):
            chosen.insert(0, state)
    return chosen

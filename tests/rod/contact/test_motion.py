"""Rods that bounce."""

from __future__ import annotations

import numpy as np

from rod.contact.obstacles import Plane
from rod.contact.skin import face, ring, side
from rod.contact.touch import Touch
from rod.loads import Weight
from rod.motion import Motion
from rod.rod import Level, Rod
from tests.rod.bars import DOWN, PLANE, Bar


def test_a_bounce_keeps_the_energy() -> None:
    """A cantilever falls on a table, and lifts off again; nothing is damped."""
    bar = Bar()
    plain = bar.rod(8, PLANE)
    outline = ring(((-8.0, -5.0), (8.0, -5.0), (8.0, 5.0), (-8.0, 5.0)), 16.0)
    skin = side(plain.layout, outline, 5.0).joined(face(plain.layout, outline))
    table = Touch(skin, Plane((0.0, -25.0, 0.0), (0.0, 1.0, 0.0)), 0.02)
    rod = Rod(plain.layout, plain.law, plain.inertia, (Weight(plain.inertia, DOWN), table))
    motion = Motion(rod, lambda time: Level(amounts=(1.0, 1.0)))
    start = motion.at(rod.layout.at_rest())
    first, worst, most, forces = motion.energy(start), 0.0, 0.0, []
    for moving in motion.run(start, 5e-4, 500):
        worst = max(worst, abs(motion.energy(moving) - first))
        velocity = moving.velocity
        most = max(most, float(np.sum(velocity @ rod.inertia * velocity)) / 2)
        forces.append(float(table.touched(rod.shape(moving.strains), 1.0).force[1]))
    assert worst < 1e-6 * most
    pressed = np.array(forces) > 0
    touches = int(np.sum(np.diff(pressed.astype(int)) == 1))
    assert touches >= 2, "it bounces"

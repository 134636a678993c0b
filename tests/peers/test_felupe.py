"""The rubber's law as felupe gets it, in felupe's own environment."""

import json
import os
import subprocess

import pytest

from bench.peers.programs import ENVIRONMENT
from bench.peers.scene import ROOT

PYTHON = ENVIRONMENT / "bin" / "python"

CODE = """
import json
import numpy as np
from bench.peers.felupe_peer import Yeoh

c1, c2 = np.array([0.11, 7.9, 0.012, 1.0]), np.array([0.02, 0.0, 0.0, 0.5])
law, random = Yeoh(c1, c2), np.random.default_rng(1)
F = np.eye(3)[:, :, None, None] + 0.2 * random.standard_normal((3, 3, 2, 4))


def energy(F):
    J = np.linalg.det(F.transpose(2, 3, 0, 1))
    excess = (F * F).sum(axis=(0, 1)) * J ** (-2 / 3) - 3
    return c1 * excess + c2 * excess**2


stress, tangent = law.gradient([F, None])[0], law.hessian([F, None])[0]
off, step = [0.0, 0.0], 1e-6
for i in range(3):
    for j in range(3):
        d = np.zeros_like(F)
        d[i, j] = step
        slope = (energy(F + d) - energy(F - d)) / (2 * step)
        turned = (law.gradient([F + d, None])[0] - law.gradient([F - d, None])[0]) / (2 * step)
        off[0] = max(off[0], float(abs(slope - stress[i, j]).max()))
        off[1] = max(off[1], float(abs(turned - tangent[:, :, i, j]).max()))
print(json.dumps([off, float(abs(tangent).max())]))
"""


@pytest.mark.skipif(not PYTHON.exists(), reason="`make peers` makes felupe's environment")
def test_stress_and_tangent_are_the_derivatives_of_the_energy() -> None:
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [PYTHON, "-c", CODE], env=environment, capture_output=True, text=True, check=True
    )
    (stress, tangent), scale = json.loads(done.stdout)
    assert stress < 1e-8 * scale
    assert tangent < 1e-8 * scale

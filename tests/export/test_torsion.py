"""St. Venant's torsion of solid sections beside closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fiberbend.slender.torsion import torsion
from geometry.bodies.quads import section_mesh
from geometry.mesh.data import MeshData
from geometry.sections.size import MeshSize
from geometry.sections.table import make_actuator, section_layout

SIZE = {"length": 100.0, "cap": 10.0, "wall": 2.0}


def filled(**dimensions: object) -> MeshData:
    layout = section_layout(make_actuator(SIZE | dimensions), MeshSize(section=2, half=False))
    return section_mesh(layout)


def test_a_solid_circle() -> None:
    """GJ = π G R⁴/2, and of two materials one within the other the sum of both."""
    radius, middle, shell = 8.0, 0.4, 0.1
    mesh = filled(section="circle", radius=5.0, sheath=1.0)
    told = torsion(mesh, dict.fromkeys(mesh.regions, middle))
    assert told == pytest.approx(math.pi * middle * radius**4 / 2, rel=1e-4)
    told = torsion(mesh, {"wall": middle, "sheath": shell})
    inner = (radius - 1.0) ** 4
    exact = math.pi / 2 * (middle * inner + shell * (radius**4 - inner))
    assert told == pytest.approx(exact, rel=1e-4)


def test_a_solid_rectangle() -> None:
    """J by St. Venant's series."""
    mesh = filled(section="rectangle", width=16.0, height=8.0, floor=2.0)
    a, b = np.ptp(mesh.nodes[:, :2], axis=0)
    odd = np.arange(1, 100, 2)
    series = float(np.sum(np.tanh(odd * math.pi * a / (2 * b)) / odd**5))
    exact = a * b**3 / 3 * (1 - 192 * b / (math.pi**5 * a) * series)
    told = torsion(mesh, dict.fromkeys(mesh.regions, 1.0))
    assert told == pytest.approx(exact, rel=1e-3)

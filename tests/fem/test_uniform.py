"""Section and cell: derivatives in fields and scalars, exact values, and their limits."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Iterable

import numpy as np
import pytest
import scipy.sparse.linalg
from petsc4py import PETSc

from fem.effects.chamber_pressure import ChamberPressure
from fem.effects.effect import Effect
from fem.effects.fabric import Strip
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Symmetry, TwofoldAxis
from fem.effects.winding import CalibratedWinding, SmearedWinding
from fem.effects.winding import Winding as Discrete
from fem.kinematics.cell import Cell
from fem.kinematics.domain import Domain
from fem.kinematics.kinematics import Kinematics
from fem.kinematics.section import Section
from fem.kinematics.uniform import CURVATURE, SIDE, STRETCH, TWIST, CurvatureAngle, Uniform
from fem.scene import Scene
from geometry.bodies.extrude import hexahedral_slice, section_quadrilaterals
from geometry.sections.size import MeshSize
from geometry.winding.embed import embed
from geometry.winding.helix import Winding
from geometry.winding.smear import smear
from geometry.winding.strip import Window, lay
from tests.fem.parts import BULGING, EA, SHORT, Floats, law, perturb

PITCH = 3.0
REGIONS = ("wall", "floor", "sheath")
STENCIL = ((1, 2 / 3), (2, -1 / 12))
"""Central differences of order 4."""

Make = Callable[[Domain, Iterable[str]], Kinematics]


@dataclasses.dataclass(frozen=True)
class _Freedom:
    """What symmetry leaves.

    Attributes:
        half: half the section stands for the whole.
        twisted: no mirror plane z = 0.
        sideways: neither a mirror plane x = 0 nor half a turn about y.
    """

    half: bool
    twisted: bool
    sideways: bool


FREEDOMS = {
    "in its plane": _Freedom(True, False, False),
    "twisted": _Freedom(True, True, False),
    "sideways": _Freedom(False, False, True),
    "free": _Freedom(False, True, True),
}
ALL = [
    pytest.param(name, marks=pytest.mark.long if name in ("twisted", "sideways") else ())
    for name in FREEDOMS
]
"""Each has kernels of its own to compile; "free" has the scalars of the two that are long."""


@functools.cache
def _domain(model: str, half: bool = True) -> Domain:
    size = MeshSize(section=1, half=half)
    if model == "section":
        return Domain(section_quadrilaterals(SHORT, size))
    return Domain(hexahedral_slice(SHORT, size, PITCH / 2, 1))


def _kind(model: str, freedom: str) -> Make:
    """Its kinematics; a whole slice has tied ends."""
    how = FREEDOMS[freedom]
    length, free = SHORT.length, (how.twisted, how.sideways)
    if model == "section":
        return lambda domain, fields: Section(domain, fields, length, *free)
    return lambda domain, fields: Cell(domain, fields, length, *free)


def _effects(domain: Domain, name: str) -> list[Effect]:
    mesh, helix = domain.data, Winding("double-helix", PITCH, 0.38)
    soft = law("neo-hooke", REGIONS, scale=1e-9)
    if name == "solid":
        return [law("yeoh", REGIONS), Incompressible({"wall": 40.0})]
    if name == "pressure":
        return [ChamberPressure()]
    if name == "strip":
        laid = lay(mesh, SHORT, Window(11.0, 7.0))
        return [soft, Strip("here", laid, 40.0), Strip("there", laid, 30.0, tension_only=True)]
    if name == "smeared":
        return [soft, SmearedWinding(smear(mesh, SHORT, helix), EA)]
    if name == "calibrated":
        return [soft, CalibratedWinding(smear(mesh, SHORT, helix), EA, BULGING)]
    if name == "calibrated helix":
        helix = Winding("single-helix-left", 15.0, 0.38)
        return [soft, CalibratedWinding(smear(mesh, SHORT, helix), EA, BULGING)]
    return [soft, Discrete(embed(mesh, SHORT, helix), EA)]


@functools.cache
def _scene(name: str, model: str, freedom: str) -> Scene:
    domain = _domain(model, FREEDOMS[freedom].half)
    return Scene(domain, _effects(domain, name), _kind(model, freedom))


CASES = [
    pytest.param(name, model, *freedom.values, marks=freedom.marks)
    for name, models in {
        "solid": ("section", "cell"),
        "pressure": ("section", "cell"),
        "smeared": ("section",),
        "strip": ("section", "cell"),
        "calibrated": ("section", "cell"),
        "calibrated helix": ("section",),
        "discrete": ("cell",),
    }.items()
    for model in models
    for freedom in ALL
]
cases = pytest.mark.parametrize(("name", "model", "freedom"), CASES)


class _Bordered:
    """Π, R and K in the fields and the natural scalars together."""

    def __init__(self, scene: Scene) -> None:
        self.scene, self.names = scene, scene.natural
        self.held = ~scene.free[: scene.body.owned]
        self.held[scene.body.ties[0]] = True

    def start(self, seed: int) -> Floats:
        """A random bent state."""
        w = perturb(self.scene, 0.03, seed)
        rest = {CURVATURE: 0.02, STRETCH: 0.97, SIDE: -0.017, TWIST: 0.013}
        return np.concatenate([w, [rest[name] for name in self.names]])

    def set(self, x: Floats) -> None:
        for name, value in zip(self.names, x[self.scene.body.owned :], strict=True):
            self.scene.set_scalar(name, float(value))
        self.scene.set(x[: self.scene.body.owned])

    def potential(self, x: Floats) -> float:
        self.set(x)
        return sum(self.scene.energies().values())

    def residual(self, x: Floats) -> Floats:
        self.set(x)
        r, _ = self.scene.residual()
        return np.concatenate([r, [-self.scene.conjugate(name) for name in self.names]])

    def tangent(self, x: Floats, v: Floats) -> Floats:
        self.set(x)
        scene, owned = self.scene, self.scene.body.owned
        matrix = scene.assemble_tangent()
        a, b = matrix.createVecs()
        a.array_w[:] = v[:owned]
        matrix.mult(a, b)
        columns = np.array([scene.load(name, constrained=True) for name in self.names])
        corner = [[scene.second_derivative(i, j) for j in self.names] for i in self.names]
        field = b.array_r + v[owned:] @ columns
        field[self.held] = 0.0
        return np.concatenate([field, columns @ v[:owned] + corner @ v[owned:]])

    def direction(self, seed: int) -> Floats:
        """Random; the scalars vary as much as they matter; held dofs stay."""
        rng, owned = np.random.default_rng(seed), self.scene.body.owned
        v = rng.uniform(-1, 1, owned + len(self.names))
        v[:owned][self.held] = 0.0
        v[owned:] *= 0.05
        return v


def _differences(f: Callable[[Floats], Floats | float], x: Floats, v: Floats, h: float) -> Floats:
    return np.asarray(sum(c * (f(x + k * h * v) - f(x - k * h * v)) for k, c in STENCIL)) / h


@cases
def test_residual_is_the_derivative_of_the_potential(name: str, model: str, freedom: str) -> None:
    # in the scalars too: moment, axial force and torque are derivatives of the same potential
    both = _Bordered(_scene(name, model, freedom))
    x = both.start(1)
    v = both.direction(2)
    held = both.held
    r = both.residual(x)
    r[: len(held)][held] = 0.0
    slope = float(_differences(both.potential, x, v, 1e-4))
    assert r @ v == pytest.approx(slope, rel=1e-6)
    assert np.abs(r[len(held) :]).min() > 0


@cases
def test_tangent_is_the_derivative_of_the_residual(name: str, model: str, freedom: str) -> None:
    # rows, columns and corner of the scalars as well as K
    both = _Bordered(_scene(name, model, freedom))
    x, v = both.start(3), both.direction(4)
    slope = _differences(both.residual, x, v, 1e-4)
    held = both.held
    slope[: len(held)][held] = 0.0
    product = both.tangent(x, v)
    assert np.abs(product - slope).max() <= 2e-7 * np.abs(slope).max()
    tail = slice(len(held), None)
    assert product[tail] == pytest.approx(slope[tail], abs=1e-6 * np.abs(slope[tail]).max())


@pytest.mark.parametrize("freedom", ALL)
@pytest.mark.parametrize("model", ["section", "cell"])
def test_volume_of_an_undeformed_section_swept_along_an_arc(model: str, freedom: str) -> None:
    # u = 0: V = λ0 A + k ∫ y dA of the chamber, whatever twist and side curvature, for ∫ x dA = 0;
    # half a disk of radius 8, y = 2
    scene = _scene("pressure", model, freedom)
    k, stretch = 0.03, 1.2
    for key, value in {CURVATURE: k, STRETCH: stretch, SIDE: 0.02, TWIST: 0.04}.items():
        if key in scene.natural:
            scene.set_scalar(key, value)
    scene.set(np.zeros(scene.body.owned))
    area, moment = np.pi * 8**2 / 2, 2 / 3 * 8**3 + np.pi * 8**2 / 2 * 2
    per_length = scene.conjugate("pressure") * scene.body.symmetry_factor / SHORT.length
    # quadratic arcs of 22.5° lose 5e-5 of the area
    assert per_length == pytest.approx(stretch * area + k * moment, rel=1e-4)


@pytest.mark.parametrize("model", ["section", "cell"])
def test_volume_of_a_cylinder_that_twists_about_another_axis(model: str) -> None:
    # moved sideways by c the chamber runs along a helix about the pin: its section across z, and so
    # the volume per z, do not change
    scene = _scene("pressure", model, "twisted")
    w = np.zeros(scene.body.owned)
    for key, value in {CURVATURE: 0.0, STRETCH: 1.0, TWIST: 0.05}.items():
        scene.set_scalar(key, value)
    w[scene.body.node_dofs[:, 1]] = 4.0
    scene.set(w)
    moved = scene.conjugate("pressure")
    scene.set(np.zeros(scene.body.owned))
    assert moved == pytest.approx(scene.conjugate("pressure"), rel=1e-12)


@pytest.mark.parametrize("freedom", ALL)
@pytest.mark.parametrize("model", ["section", "cell", "pitch"])
def test_angle_is_differentiated_in_fields_and_scalars(model: str, freedom: str) -> None:
    # what Newton borders with where an angle is given; a whole pitch has tied ends
    how = FREEDOMS[freedom]
    if model == "pitch":
        size = MeshSize(section=1, half=False)
        slab = Domain(hexahedral_slice(SHORT, size, PITCH, 2))
        body: Kinematics = Cell(slab, ["u"], SHORT.length, how.twisted, how.sideways)
    else:
        body = _kind(model, freedom)(_domain(model, how.half), ["u"])
    assert isinstance(body, Uniform)
    angle, w, random = CurvatureAngle(body), body.w.x.array, np.random.default_rng(2)
    state = {CURVATURE: 0.03, STRETCH: 1.1, SIDE: 0.02, TWIST: -0.05}
    state = {name: value for name, value in state.items() if name in body.natural}
    for name, value in state.items():
        body.scalars[name].value = value
    follow, lead = body.ties

    def put(values: Floats) -> None:
        w[:] = values
        w[follow] = w[lead]

    base, step = random.uniform(-0.5, 0.5, len(w)), random.uniform(-1, 1, len(w))
    put(base)
    row = angle.row()
    assert np.all(row[follow] == 0)
    slope = {name: angle.slope(name) for name in state}
    found = 0.0
    for k, weight in STENCIL:
        for sign in (1, -1):
            put(base + sign * k * 1e-3 * step)
            found += sign * weight * angle.value() / 1e-3
    assert float(row @ step) == pytest.approx(found, rel=1e-9, abs=1e-12)
    assert bool(np.any(row)) == (freedom != "in its plane")
    put(base)
    for name, value in state.items():
        found = 0.0
        for k, weight in STENCIL:
            for sign in (1, -1):
                body.scalars[name].value = value + sign * k * 1e-4
                found += sign * weight * angle.value() / 1e-4
        body.scalars[name].value = value
        assert slope[name] == pytest.approx(found, rel=1e-8, abs=1e-9), name
    assert angle.slope("pressure") == 0.0


def test_in_its_plane_the_angle_is_that_of_every_line() -> None:
    body = Section(_domain("section"), ["u"], SHORT.length)
    body.scalars[CURVATURE].value, body.scalars[STRETCH].value = 0.04, 0.97
    body.w.x.array[:] = np.random.default_rng(1).uniform(-0.5, 0.5, len(body.w.x.array))
    line = body.centre_line()
    assert CurvatureAngle(body).value() == 0.04 * SHORT.length
    assert line.rates == pytest.approx([0.04, 0.0, 0.0], abs=1e-15)
    assert line.stretch == pytest.approx(0.97 + 0.04 * line.centre[1])


@pytest.mark.parametrize("freedom", ALL)
@pytest.mark.parametrize("model", ["section", "cell"])
def test_pins_take_every_rigid_motion_away_and_nothing_else(model: str, freedom: str) -> None:
    # as many motions of fields and scalars together have no stiffness at rest as there are pins
    how = FREEDOMS[freedom]
    effects = [law("yeoh", REGIONS), Incompressible(dict.fromkeys(REGIONS, 40.0))]
    if how.half:
        effects.append(TwofoldAxis() if how.twisted else Symmetry())
    if model == "cell" and how.half and not how.twisted:
        effects += [Symmetry("section_root", 2), Symmetry("section_tip", 2)]
    scene = Scene(_domain(model, how.half), effects, _kind(model, freedom))
    body, names = scene.body, scene.natural
    scene.set(np.zeros(body.owned))
    pins = np.array([body.node_dofs[pin] for pin in body.pins])
    assert not scene.free[pins].any()
    scene.free[pins] = True
    own = scene.assemble_tangent().convert("aij", PETSc.Mat())
    row, column, value = own.getValuesCSR()
    whole = scipy.sparse.csr_matrix((value, column, row))
    loads = np.array([scene.load(name) for name in names]).T
    corner = np.array([[scene.second_derivative(i, j) for j in names] for i in names])
    whole = scipy.sparse.bmat([[whole, loads], [loads.T, corner]]).tocsc()
    values = scipy.sparse.linalg.eigsh(whole, len(pins) + 1, sigma=-1e-6)[0]
    small = np.sort(np.abs(values))
    assert small[: len(pins)].max() < 1e-10
    assert small[len(pins)] > 1e-5

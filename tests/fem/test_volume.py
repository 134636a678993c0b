"""The volume that elements keep: known states, and what an equilibrium is held to."""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI

from fem.effects.chamber_pressure import ChamberPressure
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Symmetry
from fem.kinematics.domain import Domain
from fem.results.volume import VolumeError, VolumeProbe
from fem.scene import Scene
from fem.solver.newton import Newton, Settings
from geometry.checks import region_volumes
from geometry.mesh.tets import to_tetrahedra
from tests.exact.solids import box, tube_sector
from tests.fem.parts import CELLS, bender, law, set_positions, stub

DILATION = 1.03


def _read(scene: Scene) -> VolumeError:
    probe = VolumeProbe.of(scene)
    assert probe is not None
    return probe.read()


@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize("factor", [DILATION, 1 / DILATION])
def test_a_uniform_dilation_is_what_it_is(cell: str, factor: float) -> None:
    domain = stub(cell)
    scene = Scene(domain, [Incompressible()])
    rest = _read(scene)
    assert max(rest.element, rest.whole) < 1e-14
    set_positions(scene, factor * domain.data.nodes)
    found, exact = _read(scene), abs(factor**3 - 1)
    assert found.element == pytest.approx(exact, rel=1e-11)
    assert found.whole == pytest.approx(exact, rel=1e-11)


@pytest.mark.parametrize("cell", CELLS)
def test_the_greatest_is_of_one_element_and_may_be_a_loss(cell: str) -> None:
    # J − 1 = 2a (z − 3) is −4a, 0 on the means of two layers of 2 mm, −2a on that of all
    mesh = box((4.0, 4.0, 4.0), (2, 2, 2))
    mesh = to_tetrahedra(mesh) if cell == "tetrahedron" else mesh
    domain, a = Domain(mesh, MPI.COMM_SELF), 0.02
    scene = Scene(domain, [Incompressible()])
    x = mesh.nodes.copy()
    x[:, 2] += a * (x[:, 2] ** 2 - 6 * x[:, 2])
    set_positions(scene, x)
    # the mean over a tetrahedron is the value at its centroid
    corners = mesh.nodes[mesh.cells[:, :4], 2].mean(axis=1)
    lowest = 1.0 if cell == "hexahedron" else float(corners.min())
    found = _read(scene)
    assert found.element == pytest.approx(2 * a * (3 - lowest), rel=1e-11)
    assert found.whole == pytest.approx(2 * a, rel=1e-11)


@pytest.mark.parametrize("cell", CELLS)
def test_what_a_bulk_modulus_asks_for_is_no_error(cell: str) -> None:
    domain, bulk, change = stub(cell), 20.0, DILATION**3 - 1
    scene = Scene(domain, [Incompressible({"wall": bulk})])
    set_positions(scene, DILATION * domain.data.nodes)
    assert _read(scene).element == pytest.approx(change, rel=1e-11)
    w = scene.w.copy()
    w[scene.body.dofs("p").ravel()] = bulk * change
    scene.set(w)
    found, volumes = _read(scene), region_volumes(domain.data)
    stiff = 1 - volumes["wall"] / sum(volumes.values())
    assert found.element == pytest.approx(change, rel=1e-11)
    assert found.whole == pytest.approx(stiff * change, rel=1e-6)
    everywhere = Scene(domain, [Incompressible(dict.fromkeys(volumes, bulk))])
    set_positions(everywhere, DILATION * domain.data.nodes)
    everywhere.set(w)
    assert _read(everywhere).element < 1e-14


def test_without_incompressible_rubber_there_is_nothing_to_keep() -> None:
    assert VolumeProbe.of(Scene(stub("hexahedron"), [law("yeoh", ["wall"])])) is None


def _inflated(cell: str, divisions: tuple[int, int, int]) -> Scene:
    """A quarter of a tube between planes, blown up."""
    mesh = tube_sector(8.0, 10.0, np.pi / 2, 3.0, divisions)
    domain = Domain(to_tetrahedra(mesh) if cell == "tetrahedron" else mesh, MPI.COMM_SELF)
    planes = {"start": 1, "end": 0, "bottom": 2, "top": 2}
    supports = [Symmetry(surface, component) for surface, component in planes.items()]
    yeoh, pressure = law("yeoh", ["solid"]), ChamberPressure("inner")
    scene = Scene(domain, [yeoh, Incompressible(), pressure, *supports])
    newton = Newton(scene, domain.comm, Settings())
    for kpa in (10, 20):
        scene.set_scalar("pressure", 1e-3 * kpa)
        outcome = newton.solve(scene.w.copy())
        assert outcome.converged, outcome.reason
    return scene


def _kept_to(scene: Scene, tolerance: float) -> float:
    """Greatest error of an element or of the whole that Newton's tolerance of volumes leaves.

    |Σ r| ≤ √n |r| over the n residuals of the pressure that make up the volume in question.
    """
    probe = VolumeProbe.of(scene)
    assert probe is not None
    volumes = probe._weights.sum(axis=1)
    left = tolerance * scene.volume_scale
    count = np.sqrt(scene.volumetric.sum())
    return float(left * max(2 / volumes.min(), count / volumes.sum()))


@pytest.mark.parametrize("cell", CELLS)
def test_an_equilibrium_keeps_what_its_elements_can(cell: str) -> None:
    scene = _inflated(cell, (2, 4, 2))
    found, bound = _read(scene), _kept_to(scene, Settings().tolerance)
    assert found.whole <= bound
    if cell == "hexahedron":
        assert found.element <= bound
        # at a point it is not kept
        assert scene.det_f() < 1 - 1e-4
    else:
        # a tetrahedron keeps its own volume only as far as the mesh is fine
        assert found.element > 1e-4
        finer = _read(_inflated(cell, (3, 6, 3)))
        assert finer.element < found.element / 1.5


def test_beside_a_fiber_det_f_is_low_and_the_volume_is_kept() -> None:
    body = bender()
    body.scene.set_scalar("pressure", 0.02)
    for _ in range(2):
        outcome = body.newton.solve(body.scene.w.copy())
    assert outcome.converged, outcome.reason
    assert body.scene.det_f() < 0.98
    found = _read(body.scene)
    assert max(found.element, found.whole) <= _kept_to(body.scene, Settings().tolerance)

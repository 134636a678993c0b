"""Recovered strains and stresses against closed forms."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from fiberbend.states.recovery import (
    NodalFields,
    cauchy_stress,
    recover,
    split_nodes,
)
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.mesh.data import Floats
from geometry.mesh.tets import to_tetrahedra
from materials.material import Material
from tests.exact.solids import box
from tests.materials.rubber import RUBBERS, uniaxial_stress
from tests.output.bending import SHORT, model_mesh, snapshot


def homogeneous(f: Floats, material: Material, p: float, element: str) -> NodalFields:
    """A box of one material deformed by x = F X under a constant multiplier."""
    mesh = box((2.0, 1.0, 3.0), (2, 1, 2))
    if element == "tetrahedron":
        mesh = to_tetrahedra(mesh)
    scene = ModelMesh(mesh, {"solid": material}, None, smeared=False, title="box")
    moved = mesh.nodes @ (f - np.eye(3)).T
    state = Snapshot("state", 1, 0.0, 0.0, moved, np.full(mesh.cells.shape, p), None)
    return recover(scene, state)


@pytest.mark.parametrize("material", RUBBERS.values(), ids=RUBBERS)
@pytest.mark.parametrize("element", ["hexahedron", "tetrahedron"])
def test_uniaxial_stretch(material: Material, element: str) -> None:
    stretch = 1.7
    f = np.diag([stretch**-0.5, stretch**-0.5, stretch])
    free = cauchy_stress(material, f, np.array(0.0))
    # the sides are free of stress: that is what p is for
    fields = homogeneous(f, material, -free[0, 0], element)
    expected = stretch * uniaxial_stress(material, np.array([stretch]))[0]
    assert fields.jacobian == pytest.approx(1.0)
    assert fields.stretches == pytest.approx(
        np.broadcast_to([stretch, stretch**-0.5, stretch**-0.5], fields.stretches.shape)
    )
    assert fields.log_strain == pytest.approx(np.log(stretch))
    assert fields.nominal_strain == pytest.approx(stretch - 1)
    assert fields.cauchy[:, 2, 2] == pytest.approx(expected)
    assert fields.cauchy[:, 0, 0] == pytest.approx(0.0, abs=1e-12)
    assert fields.von_mises == pytest.approx(expected)


@pytest.mark.parametrize("element", ["hexahedron", "tetrahedron"])
def test_volume_error_is_what_the_bulk_modulus_does_not_ask_for(element: str) -> None:
    # J = 1.03³ is all error in incompressible rubber, and none under p = κ (J − 1)
    rubber, change, bulk = Material("neo-hooke", {"mu": 0.5}), 1.03**3 - 1, 20.0
    soft = dataclasses.replace(rubber, bulk=bulk)
    f, p = 1.03 * np.eye(3), bulk * change
    assert homogeneous(f, rubber, p, element).volume_error == pytest.approx(change)
    assert homogeneous(f, soft, p, element).volume_error == pytest.approx(0, abs=1e-13)
    assert homogeneous(f, soft, 0.0, element).volume_error == pytest.approx(change)
    # a loss is negative
    squeezed = homogeneous(np.diag([1.0, 1.0, 0.9]), rubber, 0.0, element)
    assert squeezed.volume_error == pytest.approx(-0.1)


def test_simple_shear() -> None:
    # σ12 = 2 (ψ1 + ψ2) γ, σ11 − σ22 = γ σ12 (Rivlin), whatever the pressure
    gamma, material = 0.8, Material("mooney-rivlin", {"c10": 0.2, "c01": 0.1})
    f = np.eye(3)
    f[0, 1] = gamma
    fields = homogeneous(f, material, 0.3, "hexahedron")
    shear = 2 * (0.2 + 0.1) * gamma
    assert fields.cauchy[:, 0, 1] == pytest.approx(shear)
    assert fields.cauchy[:, 1, 0] == pytest.approx(shear)
    assert fields.cauchy[:, 0, 0] - fields.cauchy[:, 1, 1] == pytest.approx(gamma * shear)
    assert np.trace(fields.cauchy, axis1=1, axis2=2) == pytest.approx(3 * 0.3)
    largest = gamma / 2 + np.hypot(1.0, gamma / 2)
    assert fields.stretches[:, 0] == pytest.approx(largest)


@pytest.mark.parametrize("material", RUBBERS.values(), ids=RUBBERS)
@pytest.mark.parametrize("state", ["any", "rest", "two equal"])
def test_stress_is_the_slope_of_the_energy(material: Material, state: str) -> None:
    # P = ∂W/∂F by central differences, also where J is not 1
    p, step = 0.2, 1e-6
    f = {
        "any": np.eye(3) + 0.3 * np.random.default_rng(1).standard_normal((3, 3)),
        "rest": np.eye(3),
        "two equal": np.diag([1.4, 0.9, 0.9]),
    }[state]

    def energy(f: Floats) -> float:
        j = np.linalg.det(f)
        stretches = np.linalg.svd(j ** (-1 / 3) * f, compute_uv=False)
        return float(material.energy(*stretches) + p * (j - 1))

    slope = np.zeros((3, 3))
    for i, k in np.ndindex(3, 3):
        change = np.zeros((3, 3))
        change[i, k] = step
        slope[i, k] = (energy(f + change) - energy(f - change)) / (2 * step)
    cauchy = slope @ f.T / np.linalg.det(f)
    assert cauchy_stress(material, f, np.array(p)) == pytest.approx(cauchy, abs=1e-8)


@pytest.mark.parametrize("element", ["hexahedron", "tetrahedron"])
def test_pure_bending_stretches_by_the_distance_from_the_axis(element: str) -> None:
    scene = model_mesh(axial=1.5, element=element)
    state = snapshot(scene, 60.0)
    nodes = split_nodes(scene.mesh)
    fields = recover(scene, state, nodes)
    x = scene.mesh.nodes[nodes.node]
    inner = (x[:, 2] > 2) & (x[:, 2] < 22) & (x[:, 1] > 1.5)
    expected = 1 + np.radians(60) * (x[inner, 1] - 1) / SHORT.length
    # what second-order interpolation of the arc leaves; tetrahedra are the worse ones
    assert fields.stretches[inner, 0] == pytest.approx(expected, rel=6e-3)


def test_nothing_is_averaged_across_materials() -> None:
    scene = model_mesh()
    nodes = split_nodes(scene.mesh)
    state = snapshot(scene, 60.0)
    fields = recover(scene, state, nodes)
    alone = np.flatnonzero(scene.mesh.cell_region == scene.mesh.regions["floor"])
    mesh = dataclasses.replace(
        scene.mesh, cells=scene.mesh.cells[alone], cell_region=scene.mesh.cell_region[alone]
    )
    only = ModelMesh(mesh, scene.materials, None, smeared=False, title="")
    state = dataclasses.replace(state, multiplier=state.multiplier[alone])
    floor = recover(only, state).von_mises[split_nodes(mesh).cells]
    assert fields.von_mises[nodes.cells[alone]] == pytest.approx(floor)


def test_wrong_input_is_refused() -> None:
    scene = model_mesh()
    state = snapshot(scene, 30.0)
    with pytest.raises(ValueError, match="displacement"):
        recover(scene, dataclasses.replace(state, displacement=state.displacement[1:]))
    with pytest.raises(ValueError, match="multiplier"):
        recover(scene, dataclasses.replace(state, multiplier=state.multiplier[:, :4]))
    with pytest.raises(ValueError, match="label"):
        dataclasses.replace(state, label="a/b")
    with pytest.raises(ValueError, match="'floor' has no material"):
        dataclasses.replace(
            scene, materials=dict.fromkeys(("wall", "sheath"), RUBBERS["neo-hooke"])
        )


def test_where_the_body_is_inside_out_there_is_no_stress() -> None:
    """Between points of quadrature det F can be negative: no number, and no error."""
    f = np.stack([np.diag([1.2, 1.0, 1 / 1.2]), np.diag([-0.1, 1.0, 1.0])])
    stress = cauchy_stress(RUBBERS["yeoh"], f, np.zeros(2))
    assert np.all(np.isfinite(stress[0]))
    assert np.all(np.isnan(stress[1]))

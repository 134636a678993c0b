"""Sections as beams: Saint-Venant's flexure in closed form, and the section's own tangent."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fiberbend.beam.flexibility import Threads, flexibility
from fiberbend.beam.form import shear_form
from fiberbend.beam.kept import Beam, Threaded, beam_of, unpacked
from fiberbend.case import convert
from fiberbend.process.kept import Kept
from fiberbend.sectionlaw.stiffness import stiffness_at
from fiberbend.slender.beside import section_case
from fiberbend.slender.moments import section_of
from geometry.bodies.quads import section_mesh
from geometry.mesh.centroid import winding_weights
from geometry.sections.size import MeshSize
from geometry.sections.table import section_layout
from materials.material import Material
from rod.functions import Floats
from rod.law import Linear
from rod.layout import STRAINS
from tests.slender.rods import BASE, ROUND, case

SOFT = Material("neo-hooke", {"mu": 0.3})
YOUNG, SHEAR = 0.9, 0.3


def disk(fine: int, above: float = 0.0) -> tuple[Floats, float]:
    """F of a solid disk of one rubber about a line above its centre, and its radius."""
    actuator = convert.dimensions(case(**ROUND).actuator)
    mesh = section_mesh(section_layout(actuator, MeshSize(section=fine, half=False)))
    height = float(np.ptp(mesh.nodes[:, 1])) / 2 + mesh.nodes[:, 1].min() + above
    found = flexibility(mesh, float(height), dict.fromkeys(mesh.regions, SOFT))
    return found, actuator.outline_half_width


def test_a_disk_is_saint_venants() -> None:
    found, radius = disk(2)
    area, second = np.pi * radius**2, np.pi * radius**4 / 4
    # ∫ τ²/G of Saint-Venant's flexure with ν = ½: 27/32 of the area (Renton 1991,
    # doi 10.1016/0020-7403(91)90069-F, by energy)
    shear = SHEAR * area * 27 / 32
    exact = [shear, shear, YOUNG * area, YOUNG * second, YOUNG * second, 2 * SHEAR * second]
    np.testing.assert_allclose(1 / np.diag(found), exact, rtol=3e-4)
    off = found - np.diag(np.diag(found))
    size = np.sqrt(np.outer(np.diag(found), np.diag(found)))
    assert np.abs(off / size).max() < 1e-8


def test_another_line_is_the_same_section() -> None:
    (one, _), (other, _) = (disk(1, above) for above in (0.0, 2.5))
    # forces at a line 2.5 mm above: moments and torque about it change
    moved = np.eye(6)
    moved[3, 2], moved[5, 0] = 2.5, -2.5
    np.testing.assert_allclose(other, moved.T @ one @ moved, rtol=1e-7, atol=1e-12)
    # a force along x at that line twists as one beside the centre, which is in the disk's middle
    form = shear_form(other, STRAINS)
    assert form[0, 5] / form[0, 0] == pytest.approx(2.5, rel=1e-6)


@pytest.mark.parametrize("fine", [1, 2])
def test_at_rest_it_is_the_sections_tangent(fine: int) -> None:
    given = case()
    site, actuator = convert.site(given), convert.dimensions(given.actuator)
    layout = section_layout(actuator, MeshSize(section=fine, half=False)).without_fill()
    mesh = section_mesh(layout)
    (winding,) = (effect for effect in given.effects if effect.winds())
    (term,) = winding.build(site, mesh, convert.requests(given)).terms
    assert isinstance(term, Threaded)
    threads = [Threads(term.segments, term.stiffness)]
    height = float(winding_weights(mesh)[1][1])
    found = flexibility(mesh, height, dict(site.materials), threads)
    told = np.linalg.inv(found[2:, 2:])
    exact = stiffness_at(section_case(given), [0.0])[0].matrix
    size = np.sqrt(np.outer(np.diag(exact), np.diag(exact)))
    # the section has two elements through each part: what is left falls to a tenth
    assert np.abs((told - exact) / size).max() < (1.5e-2 if fine == 1 else 1.5e-3)


def test_symmetry_leaves_the_centre_of_shear_alone() -> None:
    given = section_case(case())
    found = beam_of(given, 0.02).chamber
    own = np.sqrt(np.outer(np.diag(found), np.diag(found)))
    # γ_x goes with the twist alone, γ_y with nothing
    mixed = np.abs(found / own)[:2]
    mixed[0, [0, 5]] = mixed[1, 1] = 0.0
    assert mixed.max() < 1e-9
    # it is toward the stiff floor
    assert -section_of(case()).height < found[0, 5] / found[5, 5] < -1.0


def test_a_tube_stiffens_alike_in_all_directions() -> None:
    tube = section_case(case(**ROUND))
    beam = beam_of(tube, 0.02)
    assert beam.alike
    law = beam.beside(Linear(np.eye(4), np.zeros(4)), STRAINS)
    np.testing.assert_allclose(law.forms[:, 0, 0], law.forms[:, 1, 1], rtol=1e-3)
    assert law.forms[1, 0, 0] > 0


def test_what_is_kept_is_found_again(tmp_path: Path) -> None:
    beam = Beam(np.eye(6), 2 * np.eye(6), np.array([1.0, 2.0, 3.0]))
    assert np.array_equal(unpacked(beam.packed()).cap, beam.cap)
    for wrong in (b"{}", b"[]", beam.packed().replace(b"1.0", b"NaN")):
        with pytest.raises(ValueError, match="no beam"):
            unpacked(wrong)
    store = Kept("beams", "flexibilities", ".json", tmp_path)
    first = beam_of(section_case(case()), 0.02, store)
    (file,) = tmp_path.glob("*.json")
    again = beam_of(
        section_case(case(**{"actuator": BASE["actuator"] | {"length": "80 mm"}})), 0.02, store
    )
    assert np.array_equal(first.chamber, again.chamber)
    assert [file] == list(tmp_path.glob("*.json"))

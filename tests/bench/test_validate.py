"""docs/validation.md: of its record, and rows of it computed again."""

from __future__ import annotations

import dataclasses
import math
import re

import numpy as np
import pytest

from analytic.tube import Held
from bench import validate
from bench.outside import beam, braid, held, others, twist
from bench.outside.table import Row, load, page, percent
from bench.outside.tubes import section
from tests.conftest import ROOT

ROWS, SECONDS = load(validate.RECORD)


def kept(quantity: str, source: str) -> Row:
    """The one row of a figure."""
    (row,) = (row for row in ROWS if row.quantity == quantity and row.source == source)
    return row


def test_the_page_is_that_of_the_record() -> None:
    assert validate.PAGE.read_text(encoding="utf-8") == validate.text(), "make validate"
    assert SECONDS < 600


def test_the_page_says_what_does_not_hold() -> None:
    missed = [row for row in ROWS if row.holds is False]
    text = validate.text()
    for row in missed:
        assert f"- {row.subject}, {row.quantity}: " in text
    assert text.count("**no**") == len(missed)
    asked = [row for row in ROWS if row.asked is not None]
    assert f"Of {len(asked)} figures with a bound {len(asked) - len(missed)} keep it." in text
    wrong = dataclasses.replace(asked[0], error=2 * (asked[0].asked or 0.0))
    assert wrong.holds is False
    with pytest.raises(ValueError, match="no source 'nowhere'"):
        page([dataclasses.replace(asked[0], source="nowhere")], 1.0, validate.SOURCES)


def test_every_source_is_quoted() -> None:
    assert {row.source for row in ROWS} == set(validate.SOURCES)


def test_small_parts_keep_their_digits() -> None:
    assert [percent(x) for x in (0.123, -0.0012, 2e-5, 0.0)] == [
        *("+12.3 %", "-0.12 %", "+2e-05", "0")
    ]


def test_modulus_of_the_twisting_tubes_is_that_of_another_fit() -> None:
    # of the same points by another code: 386 to 388 kPa
    assert 0.386 < twist.fitted() < 0.388


@pytest.mark.parametrize(("name", "bound"), [("40°, second sample", 0.03), ("50°", 0.05)])
def test_twist_is_foretold_untuned(name: str, bound: float) -> None:
    sample = twist.SAMPLES[name]
    found = np.array([s.twist * twist.LENGTH for s in twist.states(twist.fitted(), sample)])
    rms = float(np.sqrt(np.mean((found - sample.twist) ** 2))) / max(sample.twist)
    assert rms < bound
    row = kept(f"{name}: twist, untuned; off: rms over the greatest", "Bruder 2017")
    # the row is of the section, whose fibers give a little
    assert row.error == pytest.approx(rms, abs=5e-4)
    assert row.asked == bound


def test_other_samples_twist_as_if_wound_elsewhere() -> None:
    lean, rest = twist.leaning(twist.fitted(), twist.SAMPLES["20°"])
    assert lean == pytest.approx(27.8, abs=0.1)
    assert rest < 0.01


def test_tubes_whose_ends_are_held() -> None:
    for degrees, measured in held.MEASURED.items():
        exact, found = held.slopes(degrees), held.computed(degrees)
        assert np.sign(exact).tolist() == np.sign(measured).tolist()
        assert found == pytest.approx(exact, rel=held.NEAR)
        for name, ours, theirs, asked in zip(
            held.NAMES, found, measured, held.ASKED[degrees], strict=True
        ):
            other = held.both_measures(ours, theirs, asked)
            row = kept(f"{degrees:+g}°: {name}{other}", "Bruder 2018")
            assert row.error == pytest.approx(ours / theirs - 1, abs=1e-6)
            assert bool(other) == (row.holds is False)


def test_a_held_tube_that_is_longer_is_the_exact_one() -> None:
    row = held.beside_theory(48.0)
    old = kept(row.quantity, "theory")
    assert row.error == pytest.approx(old.error, abs=1e-6)
    assert row.asked == held.NEAR == 1e-3
    for each in ROWS:
        if each.subject == held.SUBJECT and each.source == "theory":
            assert each.holds


def test_what_is_exact_is_computed_again() -> None:
    for row in (*braid.locking(), *braid.torsion()):
        old = kept(row.quantity, row.source)
        assert (row.computed, row.outside) == (old.computed, old.outside)
        assert row.holds


def test_a_section_is_the_exact_tube_again() -> None:
    threads = braid.WOUND["one, and half as much at −70°"](40.0)
    families = (each.family(braid.TUBE.outer) for each in threads)
    known = braid.TUBE.wound(*families).solve(Held(pressure=braid.PRESSURE))
    row = section(braid.TUBE, threads, [braid.PRESSURE])[0]
    assert row["axis_stretch"] == pytest.approx(known.stretch, rel=braid.ASKED)
    twist_angle = known.twist * braid.TUBE.length
    assert math.radians(row["twist_deg"]) == pytest.approx(twist_angle, rel=braid.ASKED)


def test_a_coarse_beam_is_near_the_one_of_the_page() -> None:
    coarse = beam.solve(1)
    for load_of, seen in beam.COMSOL.items():
        ours = [coarse[load_of][name] for name in beam.POINTS]
        assert ours == pytest.approx(seen, rel=0.01)


def test_markers_are_those_of_the_shipped_file() -> None:
    seen = beam.measured()
    assert seen[0.0]["right"] == pytest.approx(-6.244, abs=1e-3)
    assert seen[1.00062]["top, middle"] == pytest.approx(-27.083, abs=1e-3)
    folder = beam.MARKERS.parent
    sources = (folder / "SOURCES.md").read_text(encoding="utf-8")
    for path in folder.iterdir():
        assert path.name in sources or path.name == "SOURCES.md"
    assert "Permission is hereby granted" in sources


def test_an_edge_load_is_one_of_the_edge_alone() -> None:
    """The work-conjugate of its force is the edge's own mean displacement."""
    from mpi4py import MPI

    from fem.effects.elastic import Elastic
    from fem.kinematics.domain import Domain
    from fem.scene import Scene

    n = 1
    data = beam.mesh(n)
    load_of = beam.EdgeLoad(beam.LENGTH / (6 * n), beam.SIDE)
    rubber = Elastic("neo-hooke", {"solid": {"mu": beam.MU}})
    scene = Scene(Domain(data, MPI.COMM_SELF), [rubber, load_of])
    # a quadratic of the length; half of the edge is modelled
    z = data.nodes[scene.body.owned_nodes, 2] / beam.LENGTH
    u = np.zeros((len(z), 3))
    u[:, 1] = 0.3 * z + 0.2 * z**2
    scene.body.set_displacement(u)
    scene.set(scene.w.copy())
    assert scene.conjugate(beam.EdgeLoad.scalar) == pytest.approx(-0.5 / 2, rel=1e-12)


def test_programs_of_the_page_of_peers() -> None:
    text = (ROOT / "docs" / "evidence" / "peers.md").read_text(encoding="utf-8")
    found = others.peers_page(text)
    assert found["CalculiX C3D20R"] == pytest.approx((46.77, 89.82))
    for name, values in found.items():
        for goal, value in zip(others.PEER_GOALS, values, strict=True):
            row = kept(f"P at {goal:g}°, mesh of 1 × 8 mm in both", name)
            assert row.outside == f"{value:.2f} kPa"
    with pytest.raises(ValueError, match="no row of CalculiX"):
        others.peers_page("nothing")


def test_the_page_is_short_of_words() -> None:
    # cells are read across: none of them a paragraph
    for row in ROWS:
        assert len(row.quantity) < 200, row.quantity
        assert len(row.unknown) < 220, row.unknown
        assert not re.search(r"\|", row.quantity + row.unknown)

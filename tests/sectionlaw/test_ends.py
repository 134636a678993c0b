"""What caps make of the chamber's ends: that of a longer body, of a mirror image, kept and read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fem.results.centre_line import CentreLine, face_axes, turn_of
from fiberbend.case.case import Case
from fiberbend.process.kept import Kept
from fiberbend.schema.problems import CaseError
from fiberbend.sectionlaw import ends
from fiberbend.sectionlaw.ends import PARTS, Ends, ends_of, kept, unpacked
from fiberbend.slender.laws import cap_law
from fiberbend.slender.moments import section_of
from fiberbend.trial.solve import solve
from fiberbend.trial.wanted import Wanted
from fiberbend.uniform.small import Small
from rod.law import Linear
from rod.layout import Layout
from tests.trial.cases import Data, checked, shipped, under

GREATEST = 0.06
FREE: Data = under(shipped("free_bending_smeared"), to="60 kPa")
FREE["output"] = {}
TUBE: Data = under(shipped("twisting", model="body"), to="20 kPa")
TUBE["output"] = {}
TUBE["actuator"]["cap"] = "6 mm"
TUBE["effects"][1]["winding"]["as"] = "smeared"


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Kept:
    return kept(tmp_path_factory.mktemp("cache") / "ends")


@pytest.fixture(scope="module")
def free(store: Kept) -> Ends:
    return ends_of(checked(FREE), GREATEST, store)


def test_a_longer_body_has_the_same_ends(free: Ends) -> None:
    case: Case
    section, case = ends._short(checked(FREE), GREATEST)
    length = 100.0
    update = {"actuator": case.actuator.model_copy(update={"length": length})}
    case, section = case.model_copy(update=update), section.model_copy(update=update)
    (uniform,) = solve(section, Wanted(pressures=(GREATEST,))).free
    longer = Small(case)
    states, _ = longer.march()
    longer.put(states[-1])
    body = longer.scene.body
    line = CentreLine(body)
    root, tip = line.end_axes()
    assert turn_of(np.eye(3), root)[0] == pytest.approx(
        free.added("root cap", GREATEST)[1], rel=0.01
    )
    assert turn_of(tip, face_axes(body, "tip"))[0] == pytest.approx(
        free.added("tip cap", GREATEST)[1], rel=0.01
    )
    both = free.added("root end", GREATEST)[1] + free.added("tip end", GREATEST)[1]
    assert line.turns()[0] - uniform.angle == pytest.approx(both, rel=0.03)
    assert both > 0.015


def test_ends_turn_in_the_plane_of_bending_alone(free: Ends) -> None:
    for part in PARTS:
        turns = free.added(part, GREATEST)[1:]
        assert turns[0] > 0.005
        assert np.abs(turns[1:]).max() < 1e-9
        assert not free.added(part, 0.0).any()


@pytest.mark.long
def test_under_a_vacuum_ends_turn_the_other_way(free: Ends, store: Kept) -> None:
    """At first as far as a pressure turns them: caps; the ends of the chamber hardly do."""
    vacuum = ends_of(checked(FREE), -0.008, store)
    for number, part in enumerate(PARTS):
        slopes = [each.coefficients[number, 0, 1] for each in (free, vacuum)]
        assert slopes[1] == pytest.approx(slopes[0], rel=0.03, abs=5e-3)
        assert slopes[1] > 0
        if part.endswith("cap"):
            assert vacuum.added(part, -0.008)[1] < -1e-3


def test_the_clamp_makes_the_root_stiffer_than_a_beam(free: Ends) -> None:
    case = checked(FREE)
    beam = cap_law(case, section_of(case), ("stretch", "curvature"))
    turn = 15.0 * np.linalg.inv(beam.stiffness)[1, 1]
    assert free.flexibility == pytest.approx(turn / 1.15, rel=0.02)


@pytest.mark.long
def test_a_tube_turns_about_its_line_and_its_mirror_image_the_other_way(store: Kept) -> None:
    left = ends_of(checked(TUBE), 0.02, store)
    (family,) = TUBE["effects"][1]["winding"]["families"]
    mirrored = under(TUBE, to="20 kPa")
    mirrored["effects"][1]["winding"]["families"] = [family | {"hand": "right"}]
    right = ends_of(checked(mirrored), 0.02, store)
    for part in PARTS:
        one, other = left.added(part, 0.02), right.added(part, 0.02)
        assert one[3] == pytest.approx(-other[3], rel=1e-5, abs=1e-8)
        assert one[0] == pytest.approx(other[0], rel=1e-5, abs=1e-8)
        assert np.abs(one[1:3]).max() < 1e-6
    assert abs(left.added("root end", 0.02)[3]) > 1e-3


def test_ends_are_kept_and_read(free: Ends, store: Kept, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_given: object) -> Ends:
        raise AssertionError("they are in the store")

    monkeypatch.setattr(ends, "_solved", refused)
    again = ends_of(checked(FREE), GREATEST, store)
    assert again.zone == free.zone == 15.0
    assert np.array_equal(again.coefficients, free.coefficients)
    with pytest.raises(AssertionError, match="in the store"):
        ends_of(checked(FREE), 0.05, store)


def test_what_is_damaged_is_made_anew(free: Ends, tmp_path: Path) -> None:
    content = free.packed()
    for damaged in (content[:-20], b"{}", b"[]", content.replace(b"0.", b"NaN", 1)):
        with pytest.raises(ValueError, match="no ends"):
            unpacked(damaged)
    store = kept(tmp_path)
    store.write("a", b"{")
    assert store.read("a", unpacked) is None
    assert "damaged" in store.remarks[-1]


@pytest.mark.parametrize("strains", [("stretch", "curvature"), ("shear_y", "curvature", "twist")])
def test_the_offset_of_a_law_is_spread_over_its_parts(free: Ends, strains: tuple[str, ...]) -> None:
    lengths = np.array([7.5] * 2 + [5.0] * 12 + [15.0])
    layout = Layout(lengths, strains)
    law = Linear(np.diag(np.linspace(100.0, 4000.0, len(strains))), layout.at_rest()[0])
    found = free.offset(law, layout, slice(2, 14))
    forces = found.gradient(layout.at_rest(), GREATEST)
    # from rest to where no force acts
    alone = -np.linalg.solve(law.hessian(layout.at_rest(), GREATEST), forces[..., None])[..., 0]
    turns = lengths * alone[:, strains.index("curvature")]
    parts = [turns[:2].sum(), turns[2:5].sum(), turns[11:14].sum(), turns[14]]
    for part, turn in zip(PARTS, parts, strict=True):
        assert turn == pytest.approx(free.added(part, GREATEST)[1], rel=1e-12)
    assert not turns[5:11].any()


def test_zones_are_refused() -> None:
    with pytest.raises(CaseError, match="zones"):
        ends_of(checked(shipped("thumb")), 0.02)

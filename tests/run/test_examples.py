"""Every example runs, says what physics must be, and leaves its pictures."""

from __future__ import annotations

from pathlib import Path

import pytest

from examples import blocked_tip, contact, free_bend, sweep, twist


@pytest.mark.long
def test_free_bend(tmp_path: Path) -> None:
    found = free_bend.main(tmp_path)
    for section, cell in zip(found["section"], found["cell"], strict=True):
        # rubber bulges between the turns: 3.5 to 5 % (docs/crosscheck.md)
        assert 1.02 < cell / section < 1.06
    assert found["section"] == sorted(found["section"])
    assert (tmp_path / "cell" / "pictures" / "bent.png").exists()


@pytest.mark.long
def test_blocked_tip(tmp_path: Path) -> None:
    body, section = blocked_tip.main(tmp_path)
    assert 0 < body < section
    assert (tmp_path / "body" / "pictures" / "tip_force.png").exists()


@pytest.mark.long
def test_contact(tmp_path: Path) -> None:
    touched, force = contact.main(tmp_path)
    assert 0 < touched < 60
    assert force > 0, "the table pushes up"
    assert (tmp_path / "pictures" / "pressure_angle.png").exists()


@pytest.mark.long
def test_twist(tmp_path: Path) -> None:
    found = twist.main(tmp_path)
    (left, one), (right, other) = found["left"], found["right"]
    # mirror images
    assert left == pytest.approx(right, rel=1e-6)
    assert one == pytest.approx(-other, rel=1e-6)
    assert one > 1


@pytest.mark.long
def test_sweep(tmp_path: Path) -> None:
    found = sweep.main(tmp_path)
    assert len(found) == 9
    at = found.frame.set_index(["radius_mm", "wall_mm"])["pressure_90deg_kPa"]
    # Table II of Polygerinos et al. 2015: a thicker wall needs more pressure
    for radius in (6, 8, 10):
        assert at[radius, 1.5] < at[radius, 2] < at[radius, 2.5]
    assert list((tmp_path / "maps").glob("*.png"))

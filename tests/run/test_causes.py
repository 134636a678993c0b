"""What the causes of a difference are told to be."""

from __future__ import annotations

from fiberbend.compare.check import crosscheck
from tests.run.test_crosscheck import BODY, SECTION, case_of, compared, rows_of


def test_ends_are_told_to_hold_the_twist_back_and_to_turn_the_body_aside() -> None:
    rows = rows_of(middle=0.95)
    plain = compared(crosscheck(case_of(), BODY, rows, SECTION), "section").likely[0]
    assert "twist" not in plain.text
    turned = {
        **{"twist_deg": 40.0, "uniform_twist_deg": 50.0},
        **{"side_angle_deg": -2.0, "uniform_side_angle_deg": 0.1},
    }
    check = crosscheck(case_of(), BODY, [row | turned for row in rows], SECTION)
    ends = compared(check, "section").likely[0]
    assert (ends.name, ends.percent) == ("end caps", plain.percent)
    assert "-20.0 % in twist, -2.1° in side angle beside its middle half" in ends.text

"""What a design reads off the states of the section, beside what a run says of the same case."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

import fiberbend
from fiberbend.design.quantities.quantity import Quantity
from fiberbend.design.quantities.seen import Seen
from fiberbend.design.quantities.table import QUANTITIES, QuantityEntry, unwrap
from fiberbend.design.solving.models import Section
from fiberbend.reader.reader import read_case
from tests.design.made_up import ROOT, SECTION


def quantity(name: str, **keys: Any) -> Quantity[Any]:
    return unwrap(QuantityEntry.model_validate({name: keys}))


def read(case: Any, *quantities: Quantity[Any]) -> Iterator[float]:
    wanted = list(dict.fromkeys(state for each in quantities for state in each.states()))
    seen = Seen(case, Section(2).states(case, wanted))
    yield from (each.plain(each.read(seen)) for each in quantities)


def test_the_baseline_is_as_its_run_says() -> None:
    load = ["effects.0.pressure={to: 60 kPa}", "output={at_pressures: [60 kPa]}", "compare=[]"]
    case = read_case(SECTION, load)
    row = fiberbend.run(case, states=False).rows[-1]
    at = {"at": "60 kPa"}
    asked = [quantity(name, **at) for name in ("angle", "work", "filling", "tip-y", "tip-z")]
    angle, work, filling, y, z = read(case, *asked)
    assert angle == pytest.approx(row["angle_deg"], rel=1e-5)
    # a run's work is a sum over steps
    assert work == pytest.approx(row["stored_mJ"], rel=1e-4)
    rest = fiberbend.run(case, states=False).rows[0]
    assert filling == pytest.approx((row["chamber_mm3"] - rest["chamber_mm3"]) / 1e3, rel=1e-4)
    assert y == pytest.approx(row["tip_y_mm"], abs=1e-3)
    assert z == pytest.approx(row["tip_z_mm"], abs=1e-3)


def test_an_s_is_as_its_run_says() -> None:
    case = read_case(ROOT / "cases" / "s_shape.yaml", ["output={at_pressures: [24 kPa]}"])
    row = fiberbend.run(case, states=False).rows[-1]
    at = {"at": "24 kPa"}
    asked = [quantity("angle", zone=1, **at), quantity("angle", zone=2, **at)]
    asked += [quantity(name, **at) for name in ("tip-y", "tip-z")]
    first, second, y, z = read(case, *asked)
    assert first == pytest.approx(row["zone_1_angle_deg"], rel=1e-5)
    assert second == pytest.approx(row["zone_2_angle_deg"], rel=1e-5)
    assert y == pytest.approx(row["tip_y_mm"], abs=1e-3)
    assert z == pytest.approx(row["tip_z_mm"], abs=1e-3)


def test_sizes_are_those_of_the_outside() -> None:
    case = read_case(SECTION)
    asked = [quantity(name) for name in ("width", "height", "length", "rubber")]
    width, height, length, rubber = read(case, *asked)
    # radius 8, wall 2, floor 2, sheath 1, caps 15 each
    assert width == pytest.approx(22)
    assert height == pytest.approx(14)
    assert length == pytest.approx(190)
    assert 0 < rubber < width * height * length / 1e3


@pytest.mark.parametrize("name", QUANTITIES)
def test_every_quantity_has_a_text_and_a_name(name: str) -> None:
    assert QUANTITIES[name].__doc__
    assert QUANTITIES[name].name == name

"""Quantities with units."""

from __future__ import annotations

import math

import pint
import pytest

from fiberbend.schema.units import KINDS, parse, show

EVERY_FACTOR = [(name, unit) for name, kind in KINDS.items() for unit in kind.factors]


@pytest.mark.parametrize(("kind", "unit"), EVERY_FACTOR)
def test_common_factors_are_pints(kind: str, unit: str) -> None:
    expected = pint.get_application_registry().Quantity(1, unit).to(KINDS[kind].unit).magnitude
    assert parse(f"1 {unit}", kind) == pytest.approx(expected, rel=1e-14)


def test_a_number_without_a_unit_has_none() -> None:
    with pytest.raises(ValueError, match="expected a length with its unit") as error:
        parse("85", "length")
    assert "no unit" not in str(error.value)


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("8 mm", "length", 8.0),
        ("8mm", "length", 8.0),
        (" .8  cm ", "length", 8.0),
        ("1e-3 m", "length", 1.0),
        ("0.3 in", "length", 7.62),
        ("200 kPa", "pressure", 0.2),
        ("-20 kPa", "pressure", -0.02),
        ("29 psi", "pressure", 29 * 0.00689475729),
        ("90 deg", "angle", math.pi / 2),
        ("90°", "angle", math.pi / 2),
        ("0.25 turn", "angle", math.pi / 2),
        ("45 mL", "volume", 45000.0),
        ("1.1 g/cm^3", "density", 1.1e-9),
        ("1100 kg/m**3", "density", 1.1e-9),
        ("9.81 m/s^2", "acceleration", 9810.0),
    ],
)
def test_values(text: str, kind: str, value: float) -> None:
    assert parse(text, kind) == pytest.approx(value, rel=1e-8)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (8, 'expected a length with its unit such as "8 mm"'),
        (True, "expected a length with its unit"),
        ("8", "expected a length with its unit"),
        ("mm", "expected a length with its unit"),
        ("8 kPa", "expected a length with its unit"),
        ("8 degC", "expected a length with its unit"),
        ("8 parsnips", "there is no unit 'parsnips'"),
        ("nan mm", "expected a length that is finite"),
        ("-inf mm", "expected a length that is finite"),
        ("1e400 mm", "expected a length that is finite"),
        (None, "expected a length with its unit"),
        (["8 mm"], "expected a length with its unit"),
    ],
)
def test_refused(text: object, complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        parse(text, "length")


def test_a_percentage_is_no_angle() -> None:
    with pytest.raises(ValueError, match="expected an angle"):
        parse("90 percent", "angle")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("value", [1.0, 0.1, 1 / 3, math.pi, 2e-3, 1.1e-9, 45000.0, -0.02])
def test_show_loses_nothing(kind: str, value: float) -> None:
    assert parse(show(value, kind), kind) == value


def test_show_writes_what_one_would_write() -> None:
    assert show(0.2, "pressure") == "200 kPa"
    assert show(parse("90 deg", "angle"), "angle") == "90 deg"
    assert show(1.1e-9, "density") == "1.1 g/cm^3"


def test_a_number_without_a_unit_is_refused_as_that() -> None:
    """No digit of it is taken for a unit."""
    for text in ("10", "2.50", "-.5"):
        with pytest.raises(ValueError, match=r'"200 kPa"$'):
            parse(text, "pressure")

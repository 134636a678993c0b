"""Limits of manufactured sequences, whose limit and order are known."""

from __future__ import annotations

import math

import pytest

from fiberbend.ladder.richardson import ASSUMED_ORDER, extrapolate, observed_order

SIZES = {
    "halved": (1.0, 0.5, 0.25, 0.125),
    "counted": (1.0, 1 / 2, 1 / 3, 1 / 4),
    "odd": (7.53, 3.9, 2.1, 1.7),
}


@pytest.mark.parametrize("sizes", SIZES.values(), ids=SIZES)
@pytest.mark.parametrize("order", [0.7, 1.0, 1.8, 2.0, 3.9])
@pytest.mark.parametrize("constant", [2.0, -0.3])
def test_a_power_is_found(sizes: tuple[float, ...], order: float, constant: float) -> None:
    values = [45.0 + constant * h**order for h in sizes]
    assert observed_order(sizes[:3], values[:3]) == pytest.approx(order, rel=1e-6)
    for count in (3, 4):
        found = extrapolate(sizes[:count], values[:count])
        assert found.value == pytest.approx(45.0, rel=1e-9)
        assert found.order == pytest.approx(order, rel=1e-6)
        assert found.remark == ""
        beyond = abs(values[count - 1] - 45.0)
        assert found.uncertainty == pytest.approx(beyond if count == 3 else beyond / 4)


def test_the_unit_of_the_sizes_and_of_the_values_does_not_matter() -> None:
    sizes, values = (1.0, 0.5, 0.25), (3.0, 2.0, 1.6)
    found = extrapolate(sizes, values)
    scaled = extrapolate([1e3 * h for h in sizes], [-1e-6 * f for f in values])
    assert scaled.value == pytest.approx(-1e-6 * found.value)
    assert scaled.uncertainty == pytest.approx(1e-6 * found.uncertainty)
    assert scaled.order == pytest.approx(found.order)


def test_two_terms_of_the_error_lie_within_the_uncertainty() -> None:
    sizes = SIZES["counted"]
    values = [45.0 + 0.3 * h**2 + 0.2 * h**4 for h in sizes]
    for count in (3, 4):
        found = extrapolate(sizes[:count], values[:count])
        assert 0 < abs(found.value - 45.0) < found.uncertainty
        assert abs(found.value - 45.0) < abs(values[count - 1] - 45.0)


def test_two_meshes_assume_an_order_and_widen() -> None:
    values = [45.0 + h**ASSUMED_ORDER for h in (1.0, 0.5)]
    found = extrapolate((1.0, 0.5), values)
    assert found.value == pytest.approx(45.0)
    assert found.uncertainty == pytest.approx(3 * 0.25)
    assert found.order is None
    assert "assumed" in found.remark
    known = extrapolate((1.0, 0.5), [45.0 + h for h in (1.0, 0.5)], order=1.0)
    assert known.value == pytest.approx(45.0)
    assert known.uncertainty == pytest.approx(0.5)
    assert "other families" in known.remark


def test_one_mesh_tells_nothing() -> None:
    found = extrapolate((1.0,), (45.0,))
    assert found.value == 45.0
    assert math.isinf(found.uncertainty)


def test_steps_that_turn_round_are_said_and_widened() -> None:
    settling = extrapolate((1.0, 0.5, 0.25), (3.0, 2.0, 2.2))
    assert settling.value == 2.2
    assert settling.uncertainty == pytest.approx(0.2)
    growing = extrapolate((1.0, 0.5, 0.25), (2.2, 2.0, 3.0))
    assert growing.uncertainty == pytest.approx(1.0)
    assert settling.remark == growing.remark == "not monotone"
    assert settling.order is None


def test_a_logarithm_does_not_settle() -> None:
    """A thread without a width: P falls by as much at every halving."""
    sizes = (1.0, 0.5, 0.25, 0.125)
    found = extrapolate(sizes, [45.0 + 0.5 * math.log2(h) for h in sizes])
    assert found.remark == "does not settle"
    assert found.value == pytest.approx(43.5)
    assert found.uncertainty >= 3 * 1.0
    slow = extrapolate((1.0, 1 / 2, 1 / 3), (46.5876, 46.5279, 46.4827))
    assert slow.remark == "does not settle"
    assert slow.uncertainty == pytest.approx(0.0452 / (1.5**0.5 - 1), rel=1e-3)


def test_equal_values_are_their_limit() -> None:
    found = extrapolate((1.0, 0.5, 0.25), (45.0, 45.0, 45.0))
    assert (found.value, found.uncertainty, found.remark) == (45.0, 0.0, "")
    alike = extrapolate((1.0, 0.5, 0.25), (45.0, 45.0 + 1e-9, 45.0 - 1e-9))
    assert alike.value == pytest.approx(45.0)
    assert alike.uncertainty < 1e-8
    assert extrapolate((1.0, 0.5), (0.0, 0.0)).uncertainty == 0.0


def test_an_order_that_is_too_good_to_be_true_is_not_believed() -> None:
    found = extrapolate((1.0, 0.5, 0.25), (3.0, 2.0, 1.999))
    assert "above" in found.remark
    assert found.uncertainty == pytest.approx(0.001)
    assert found.value == pytest.approx(1.999 - 0.001 / 15)


@pytest.mark.parametrize(
    ("sizes", "values"),
    [((0.5, 1.0), (1.0, 2.0)), ((1.0, 1.0), (1.0, 2.0)), ((1.0, 0.0), (1.0, 2.0)), ((1.0,), ())],
)
def test_wrong_sequences_are_refused(sizes: tuple[float, ...], values: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="expected"):
        extrapolate(sizes, values)

"""Lines of constant curvature, and the tip of one."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest

from analytic.path import CentreLine, arc, cross_matrix, screw, tip

Array = npt.NDArray[np.float64]
RIGHT = math.pi / 2


def test_tip_without_cap() -> None:
    points = tip(np.radians([90, 180, 360]), 160)
    stated = np.array([[101.86, 101.86], [0, 101.86], [0, 0]])
    assert points == pytest.approx(stated, abs=0.005)
    radius = 160 / np.radians([90, 180])
    assert points[:2, 0] == pytest.approx(radius * [1, 0], abs=1e-12)
    assert points[:2, 1] == pytest.approx(radius * [1, 2], abs=1e-12)


def test_straight_actuator_is_the_limit() -> None:
    assert tip(0.0, 160, cap=15, height=4) == pytest.approx(np.array([175, -4]), abs=1e-12)
    near = tip(1e-9, 160, cap=15)
    assert near == pytest.approx(np.array([175, 1e-9 * (160 / 2 + 15)]), rel=1e-12)


def test_cap_goes_on_along_the_tangent() -> None:
    angles = np.linspace(-3, 9, 25)
    tangent = tip(angles, 160, cap=15) - tip(angles, 160)
    assert tangent == pytest.approx(15 * np.column_stack([np.cos(angles), np.sin(angles)]))
    assert tip(RIGHT, 160, cap=15) - tip(RIGHT, 160) == pytest.approx(np.array([0, 15]), abs=1e-12)


def test_height_is_normal_to_the_arc() -> None:
    angles = np.linspace(-3, 9, 25)
    normal = tip(angles, 160, height=2) - tip(angles, 160)
    assert normal == pytest.approx(2 * np.column_stack([np.sin(angles), -np.cos(angles)]))


def test_arc_has_its_length_and_its_curvature() -> None:
    share = np.linspace(0, 1, 2001)
    arc = tip(4.0 * share, 160 * share)
    assert np.hypot(*np.diff(arc, axis=0).T).sum() == pytest.approx(160, rel=1e-6)
    assert np.hypot(arc[:, 0], arc[:, 1] - 40) == pytest.approx(np.full(2001, 40.0))


@pytest.mark.parametrize(("length", "cap"), [(-1.0, 0.0), (math.nan, 0.0), (160.0, -1.0)])
def test_meaningless_lengths_are_refused(length: float, cap: float) -> None:
    with pytest.raises(ValueError, match="zero or positive mm expected"):
        tip(1.0, length, cap)


SPINS = {
    "straight": (0.0, 0.0, 0.0),
    "barely": (1e-9, 0.0, 1e-9),
    "arc": (0.04, 0.0, 0.0),
    "twist": (0.0, 0.0, 0.05),
    "helix": (0.04, 0.01, -0.03),
}
STRETCH = 1.1


def _integrated(spin: Array, length: float, number: int) -> tuple[Array, Array]:
    """Frames by the classical Runge–Kutta rule from R' = R [ω×], c' = λ R e3."""
    x, y, z = spin
    rate = np.array([[0, -z, y, 0], [z, 0, -x, 0], [-y, x, 0, STRETCH], [0, 0, 0, 0]])
    state, h = np.eye(4), length / number
    for _ in range(number):
        first = state @ rate
        second = (state + h / 2 * first) @ rate
        third = (state + h / 2 * second) @ rate
        fourth = (state + h * third) @ rate
        state = state + h / 6 * (first + 2 * second + 2 * third + fourth)
    return state[:3, :3], state[:3, 3]


@pytest.mark.parametrize("name", SPINS)
def test_screw_solves_its_differential_equation(name: str) -> None:
    spin = np.array(SPINS[name])
    rotation, place = screw(np.array([0.0, 90.0, 160.0]), spin, STRETCH)
    for i, length in ((1, 90.0), (2, 160.0)):
        frame, end = _integrated(spin, length, 4000)
        assert rotation[i] == pytest.approx(frame, abs=1e-11)
        assert place[i] == pytest.approx(end, abs=1e-9)
    assert rotation[0] == pytest.approx(np.eye(3), abs=0)
    assert place[0] == pytest.approx(np.zeros(3), abs=0)


def test_screw_without_spin_is_the_limit() -> None:
    z = np.linspace(0, 160, 9)
    straight, near = screw(z, np.zeros(3), 1.0), screw(z, np.array([1e-9, 0.0, 0.0]), 1.0)
    assert straight[1] == pytest.approx(z[:, None] * [0, 0, 1], abs=0)
    assert near[1] == pytest.approx(straight[1] - 1e-9 * z[:, None] ** 2 / 2 * [0, 1, 0], abs=1e-12)


def test_screw_of_a_full_turn_closes() -> None:
    rotation, place = screw(np.array([160.0]), np.array([math.radians(360) / 160, 0, 0]), STRETCH)
    assert rotation[0] == pytest.approx(np.eye(3), abs=1e-14)
    assert place[0] == pytest.approx(np.zeros(3), abs=1e-13)


def test_screw_in_the_plane_is_the_arc() -> None:
    z, k = np.linspace(0, 160, 33), 0.03
    rotation, place = screw(z, np.array([k, 0.0, 0.0]), STRETCH)
    end = place + rotation @ [0.0, 3.0, -2.0]
    plane = arc(k * z, STRETCH * z, ahead=-2.0, height=3.0)
    assert end == pytest.approx(np.column_stack([0 * z, -plane[:, 1], plane[:, 0]]), abs=1e-12)


def test_screw_of_a_helix_keeps_its_axis() -> None:
    # the axis is parallel to ω and passes at ω × λ e3 / |ω|² from the start
    spin = np.array(SPINS["helix"])
    place = screw(np.linspace(0, 300, 60), spin, STRETCH)[1]
    square = spin @ spin
    arms = place - np.cross(spin, [0, 0, STRETCH]) / square
    distance = np.linalg.norm(np.cross(arms, spin), axis=1) / math.sqrt(square)
    assert distance == pytest.approx(np.full(60, STRETCH * math.hypot(0.04, 0.01) / square))


def test_cross_matrix_is_the_cross_product() -> None:
    a, b = np.array([1.0, -2.0, 3.0]), np.array([0.3, 5.0, -4.0])
    assert cross_matrix(a) @ b == pytest.approx(np.cross(a, b))


def _line(k: float, twist: float, stretch: float, centre: Array) -> CentreLine:
    """Of a section that is turned and sheared a little in its frame."""
    a_x, a_y = np.array([1.1, 0.02, -0.06]), np.array([-0.01, 0.9, 0.03])
    return CentreLine.of(np.array([k, 0.0, twist]), stretch, centre, a_x, a_y)


def test_in_the_plane_every_line_has_the_same_curvature() -> None:
    for height in (-3.0, 0.0, 5.0):
        line = _line(0.02, 0.0, 1.1, np.array([0.0, height, 0.0]))
        assert line.rates == pytest.approx([0.02, 0.0, 0.0], abs=1e-16)
        assert line.stretch == pytest.approx(1.1 + 0.02 * height)


@pytest.mark.parametrize("hand", [1, -1])
def test_a_straight_twisted_tube_does_not_bend(hand: int) -> None:
    # twisted by ψ about an axis r above the frame's origin, whose own line is a helix: its frame
    # leans by atan(ψ r/λ) and has both curvature and twist
    turn, radius, stretch = hand * 0.036, 8.35, 1.08
    lean = np.arctan2(turn * radius, stretch)
    spin = turn * np.array([-np.sin(lean), 0.0, np.cos(lean)])
    line = _line(spin[0], spin[2], np.hypot(turn * radius, stretch), np.array([0.0, radius, 0.0]))
    assert line.rates == pytest.approx([0.0, 0.0, turn], abs=1e-15)
    assert line.stretch == pytest.approx(stretch, rel=1e-14)


def test_rates_are_those_of_the_curve() -> None:
    # Frenet: curvature of the placed line, and the turn of the sections about it
    line = _line(0.03, -0.05, 1.07, np.array([0.4, 6.0, -0.3]))
    z, step = np.array([11.0]), 1e-3
    at = [line.sections(z + i * step) for i in (-1, 0, 1)]
    speed = (at[2][1] - at[0][1])[0] / (2 * step)
    turn = (at[2][1] - 2 * at[1][1] + at[0][1])[0] / step**2
    assert np.linalg.norm(speed) == pytest.approx(line.stretch, rel=1e-6)
    tangent = speed / np.linalg.norm(speed)
    bend = np.linalg.norm(np.cross(tangent, turn)) / line.stretch
    assert bend == pytest.approx(np.hypot(*line.rates[:2]), rel=1e-5)
    spin = (at[2][0] - at[0][0])[0] @ at[1][0][0].T / (2 * step)
    omega = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
    assert omega @ tangent == pytest.approx(line.rates[2], rel=1e-5)
    # the pitch of the screw: what turns and what advances along it are the frame's own
    assert np.linalg.norm(line.rates) == pytest.approx(np.linalg.norm(line.spin))
    assert line.rates[2] * line.stretch == pytest.approx(-0.05 * 1.07)


def test_the_clamp_holds_the_first_section() -> None:
    line = _line(0.03, -0.05, 1.07, np.array([0.4, 6.0, -0.3]))
    rotation, place = line.sections(np.array([0.0]))
    assert rotation[0] == pytest.approx(np.eye(3), abs=1e-14)
    assert place[0] == pytest.approx(np.zeros(3), abs=1e-14)


def test_angle_of_the_image_is_the_mirrored_one() -> None:
    # x → −x of a section that its plane does not mirror: same bend, other side, other twist
    line = _line(0.03, -0.05, 1.07, np.array([0.4, 6.0, -0.3]))
    image = _line(0.03, 0.05, 1.07, np.array([-0.4, 6.0, -0.3]))
    assert image.rates == pytest.approx(line.rates * [1.0, -1.0, -1.0], abs=1e-15)
    assert image.stretch == pytest.approx(line.stretch)

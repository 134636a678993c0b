"""The law of a section by a table is that of trials and of its own energy."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fiberbend.cli import main
from fiberbend.reader.reader import parse_case
from fiberbend.schema.problems import CaseError
from fiberbend.sectionlaw import words
from fiberbend.sectionlaw.chart import Chart
from fiberbend.sectionlaw.law import PLANE, Free
from fiberbend.sectionlaw.made import Made, unpacked
from fiberbend.sectionlaw.polynomial import fit
from fiberbend.sectionlaw.states.held import Held, HeldState
from fiberbend.sectionlaw.store import Store, digest_of
from fiberbend.sectionlaw.table import refuse, table_of
from fiberbend.trial.solve import solve
from fiberbend.trial.wanted import Wanted
from rod.functions import Floats
from rod.layout import Layout
from rod.loads import TipMoment
from rod.rod import Level, Rod
from rod.statics import Path as LoadPath
from rod.statics import solve as rod_solve
from tests.trial.cases import Data, checked, shipped, under, wound

BENT: Data = under(shipped("section"), angle="120 deg")
ERROR = 1e-3
SPACE = ("stretch", "curvature", "side_curvature", "twist")
TUBE: Data = wound(
    under(shipped("extending", model="section"), to="40 kPa"),
    **{"fiber": "kevlar", "as": "smeared"},
    families=[{"angle_from_axis": "90 deg", "spacing": "3 mm"}],
)


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Store:
    return Store(tmp_path_factory.mktemp("cache") / "tables")


@pytest.fixture(scope="module")
def made(store: Store) -> Made:
    return table_of(checked(BENT), ERROR, store=store)


def places(made: Made, count: int) -> list[tuple[np.ndarray[Any, Any], float]]:
    """Strains and pressures inside the table, away from its edges."""
    random = np.random.default_rng(5)
    low, high = np.array([axis.lines[[0, -1]] for axis in made.section.table.axes]).T
    points = low + random.uniform(0.1, 0.9, (count, 3)) * (high - low)
    strains = made.section.chart.strains(points)
    return [(strains[i : i + 1], float(points[i, 2])) for i in range(count)]


def chart_of(turns: int) -> Chart:
    """A chart of a stretch and so many curvatures, all of whose numbers are in use."""
    random = np.random.default_rng(turns)
    y = random.normal(size=(60, turns + 1)) / 10
    noise = random.normal(size=60) / 10
    unpulled = fit(y, 1.0 + y.sum(axis=1) + (y**2).sum(axis=1) + noise, np.ones(60), 3, 1.0)
    number = np.arange(turns + 1)
    rows = (-0.1 * (number + 1), 0.3 * (number + 1), 0.3 + 0.1 * number, 0.5 + 0.2 * number)
    return Chart(unpulled, *(tuple(row.tolist()) for row in rows))


def to(held: Held, *ways: Floats) -> HeldState:
    """The state at the end of some places that are gone to one after another."""
    state = held.rest
    for at in ways:
        found = held.near(state, at)
        assert found is not None, at
        state = found
    return state


def slopes_by_differences(of: Callable[[Floats], Floats], at: Floats, step: float = 1e-5) -> Floats:
    """∂/∂x of a vector by central differences, a column for each x."""
    sides = [(of(at + step * e) - of(at - step * e)) / (2 * step) for e in np.eye(len(at))]
    return np.array(sides).T


@pytest.mark.parametrize("turns", [1, 2])
def test_the_chart_has_exact_derivatives(turns: int) -> None:
    chart, m = chart_of(turns), turns + 1
    at = np.array([1.1, *(0.05 * np.arange(1, m)), 0.07])
    strains, pressure = at[None, :m], 0.07

    def place(x: Floats) -> Floats:
        return np.array([*chart.place(x[None, :m], x[m])[0], x[m]])

    point = place(at)
    assert chart.strains(point[None, :])[0] == pytest.approx(at[:m], rel=1e-12)
    first = chart.first(strains, pressure)[0]
    assert first == pytest.approx(slopes_by_differences(place, at), rel=1e-7, abs=1e-7)
    assert chart.back(point[None, :])[0] @ first == pytest.approx(np.eye(m + 1), abs=1e-12)
    weights = np.linspace(1.0, -2.0, m)

    def weighed(x: Floats) -> Floats:
        return weights @ chart.first(x[None, :m], float(x[m]))[0, :m]

    second = chart.second(strains, weights[None, :], pressure)[0]
    assert second == pytest.approx(slopes_by_differences(weighed, at), rel=1e-6, abs=1e-5)
    random = np.random.default_rng(3)
    stiff = random.normal(size=(m + 1, m + 1))
    stiff, force = stiff + stiff.T, random.normal(size=m + 1)

    def carried(u: Floats) -> Floats:
        """Slopes by the chart of force · x + x · stiff x/2."""
        x = np.array([*chart.strains(u[None, :])[0], u[m]])
        return chart.carried(u[None, :], (force + stiff @ x)[None, :])[0]

    here = (force + stiff @ at)[None, :]
    bent = chart.bent(point[None, :], here, stiff[None, :])[0]
    assert bent == pytest.approx(slopes_by_differences(carried, point), rel=1e-5, abs=1e-4)
    again = chart.forces(point[None, :], chart.carried(point[None, :], here))
    assert again == pytest.approx(here, rel=1e-12)


def test_the_law_has_exact_derivatives(made: Made) -> None:
    for strains, pressure in places(made, 6):
        for number, step in enumerate((1e-5, 1e-6)):
            away = np.zeros((1, 2))
            away[0, number] = step
            sides = [made.law.value(strains + sign * away, pressure) for sign in (1, -1)]
            slope = (sides[0] - sides[1])[0] / (2 * step)
            told = made.law.gradient(strains, pressure)[0, number]
            assert told == pytest.approx(slope, rel=1e-6, abs=1e-4)
            bent = [made.law.gradient(strains + sign * away, pressure)[0] for sign in (1, -1)]
            rates = (bent[0] - bent[1]) / (2 * step)
            assert made.law.hessian(strains, pressure)[0, number] == pytest.approx(rates, rel=1e-5)
            area = [made.law.chamber(strains + sign * away, pressure)[0] for sign in (1, -1)]
            rate = (area[0] - area[1]) / (2 * step)
            told = made.law.chamber_gradient(strains, pressure)[0, number]
            assert told == pytest.approx(rate, rel=1e-5, abs=1e-3)
        step = 1e-6
        sides = [made.law.value(strains, pressure + sign * step) for sign in (1, -1)]
        area = -(sides[0] - sides[1])[0] / (2 * step)
        assert made.law.chamber(strains, pressure)[0] == pytest.approx(area, rel=1e-6)
        sides = [made.law.chamber(strains, pressure + sign * step) for sign in (1, -1)]
        rate = (sides[0] - sides[1])[0] / (2 * step)
        assert made.law.chamber_slope(strains, pressure)[0] == pytest.approx(rate, rel=1e-4)


@pytest.mark.parametrize(
    ("data", "strains"),
    [(BENT, PLANE), (TUBE, PLANE), (BENT, SPACE), (TUBE, SPACE)],
    ids=["hemicircle", "tube", "hemicircle in space", "tube in space"],
)
def test_forces_and_stiffnesses_are_slopes_of_the_solved_energy(
    data: Data, strains: tuple[str, ...]
) -> None:
    """Of states of the section, without a spline: energy, forces and area, second derivatives."""
    held = Held(checked(data), strains)
    m = len(strains)
    at = np.zeros(m + 1)
    at[:2], at[2:m], at[m] = (1.02, 0.003), 1e-3, 0.02
    state = to(held, (held.rest.at + at) / 2, at)
    steps = np.array([1e-4, *[1e-5] * (m - 1), 1e-4])
    for number, step in enumerate(steps):
        away = step * np.eye(m + 1)[number]
        ahead, behind = (to(held, (held.rest.at + at) / 2, at, at + d) for d in (away, -away))
        slope = (ahead.energy - behind.energy) / (2 * step)
        size = np.abs(state.slopes * steps).max() / step
        assert state.slopes[number] == pytest.approx(slope, abs=1e-4 * size)
        rates = (ahead.slopes - behind.slopes) / (2 * step)
        sizes = np.sqrt(np.abs(state.second[number, number] * np.diag(state.second)))
        assert np.all(np.abs(state.second[number] - rates) < 1e-5 * sizes)


def test_a_rod_takes_it(made: Made) -> None:
    """By itself it bends as the section does; a moment at its tip is that of every piece."""
    pressure, state = made.free[-1]
    layout = Layout(np.full(8, made.length / 8))
    near = np.tile([1.0 + 0.95 * (state.stretch - 1.0), 0.95 * state.curvature], (8, 1))
    level = Level(pressure, (1.0,))
    angle = state.curvature * made.length
    turns = []
    for moment in (0.0, 10.0, -10.0):
        rod = Rod(layout, made.law, terms=[TipMoment((moment, 0.0, 0.0))])
        found = rod_solve(rod, near, LoadPath(level, level), 0.0).strains
        forces = made.law.gradient(found, pressure)
        assert forces == pytest.approx(np.tile([0.0, moment], (8, 1)), abs=1e-5)
        turns.append(float(layout.lengths @ found[:, 1]))
    assert turns[0] == pytest.approx(angle, rel=1e-3)
    assert turns[2] < turns[0] < turns[1]


def test_free_states_are_those_of_trials(made: Made) -> None:
    """At pressures at which no table was compared while it was made."""
    greatest = made.section.table.axes[-1].lines[-1] / 1.05
    pressures = tuple(float(greatest * part) for part in (0.2, 0.45, 0.9))
    answer = solve(checked(BENT), Wanted(pressures=pressures))
    assert answer.converged
    angle = max(point.angle for point in answer.free)
    for point in answer.free:
        near = Free(1.0 + 0.9 * (point.stretch - 1), 0.9 * point.angle / made.length)
        found = made.section.free(point.pressure, near)
        assert found.curvature * made.length == pytest.approx(point.angle, abs=1e-3 * angle)
        assert found.stretch == pytest.approx(point.stretch, abs=1e-4)
        area = made.law.chamber(np.array([found[:2]]), point.pressure)[0]
        assert area * made.length == pytest.approx(point.volume, rel=2e-3)


def test_errors_are_those_asked_for(made: Made) -> None:
    told = made.checked
    assert max(told.force, told.moment, told.area, told.angle) <= ERROR
    assert told.states >= 32
    out = "\n".join(words.lines(made))
    for piece in ("kPa", "1/m", "not fitted", "asked for 0.1 %"):
        assert piece in out


def test_a_straight_tube_is_its_own_mirror_image(store: Store) -> None:
    made = table_of(checked(TUBE), 1e-2, store=store)
    axes = made.section.table.axes
    pressure, most = float(axes[-1].lines.mean()), -made.section.chart.least[1]
    stretch = 1.02
    for part in (0.3, 0.8):
        sides = [np.array([[stretch, sign * part * most]]) for sign in (1, -1)]
        left, right = (made.law.gradient(side, pressure)[0] for side in sides)
        scale = np.abs(left).max()
        assert left[0] == pytest.approx(right[0], abs=1e-2 * scale)
        assert left[1] == pytest.approx(-right[1], rel=2e-2)
    held = Held(checked(TUBE), PLANE)
    sign = np.array([1.0, -1.0, 1.0])
    for part in (0.3, 0.8):
        at = np.array([stretch, part * most, pressure])
        half = (held.rest.at + at) / 2
        one, other = (to(held, s * half, s * at) for s in (np.ones(3), sign))
        assert one.slopes == pytest.approx(other.slopes * sign, rel=1e-6, abs=1e-5)
        image = other.second * np.outer(sign, sign)
        assert one.second == pytest.approx(image, rel=1e-6, abs=1e-6 * np.abs(image).max())
    free = solve(checked(TUBE), Wanted(pressures=(pressure,))).free[0]
    found = made.section.free(pressure, Free(stretch, 0.0))
    assert found.stretch == pytest.approx(free.stretch, abs=2e-4)
    assert found.curvature * made.length == pytest.approx(0.0, abs=1e-3)


def test_the_cache_gives_the_same(made: Made, store: Store) -> None:
    again = table_of(checked(BENT), ERROR, store=store)
    assert again.seconds == made.seconds
    for strains, pressure in places(made, 3):
        assert np.array_equal(
            again.law.gradient(strains, pressure), made.law.gradient(strains, pressure)
        )
    assert again.packed() == made.packed()
    assert again.checked == made.checked


def test_what_enters_has_another_digest() -> None:
    digest = digest_of(checked(BENT), PLANE, ERROR, None)
    assert digest == digest_of(checked(BENT | {"title": "another"}), PLANE, ERROR, None)
    thick = {**BENT, "actuator": BENT["actuator"] | {"wall": "3 mm"}}
    soft = {**BENT, "materials": BENT["materials"] | {"wall": "ecoflex-0030"}}
    others = [thick, soft, under(BENT, angle="90 deg")]
    others.append(
        wound(BENT, pattern="double-helix", pitch="4 mm", fiber="kevlar", **{"as": "smeared"})
    )
    found = {digest_of(checked(other), PLANE, ERROR, None) for other in others}
    found |= {
        digest_of(checked(BENT), PLANE, 1e-2, None),
        digest_of(checked(BENT), PLANE, ERROR, 0.01),
    }
    assert len(found | {digest}) == 7


def test_a_damaged_table_is_no_table(made: Made, tmp_path: Path) -> None:
    kept = Store(tmp_path / "tables")
    kept.keep(made)
    file = tmp_path / "tables" / f"{made.digest}.npz"
    whole = file.read_bytes()
    for place in range(0, len(whole), len(whole) // 60):
        file.write_bytes(whole[:place] + bytes([whole[place] ^ 0xFF]) + whole[place + 1 :])
        found = kept.find(made.digest)  # zip does not check its dates
        assert found is None or found.packed() == made.packed()
        file.write_bytes(whole[:place])
        assert kept.find(made.digest) is None
    assert len(kept.remarks) > 100
    assert all("damaged" in remark for remark in kept.remarks)
    with pytest.raises(ValueError, match="no table"):
        unpacked(b"nothing")


def test_the_csv_has_units_and_all_states(made: Made) -> None:
    rows = list(csv.DictReader(io.StringIO(words.text(made))))
    assert len(rows) == len(made.samples.values)
    assert set(rows[0]) == set(words.columns(made))
    row = rows[len(rows) // 2]
    strains = np.array([[float(row["stretch"]), 1e-3 * float(row["curvature_1_per_m"])]])
    pressure = 1e-3 * float(row["pressure_kPa"])
    told = made.law.gradient(strains, pressure)[0]
    span = np.ptp(made.forces, axis=0)
    assert float(row["force_N"]) == pytest.approx(told[0], abs=ERROR * span[0])
    assert float(row["moment_Nmm"]) == pytest.approx(told[1], abs=ERROR * span[1])


@pytest.mark.parametrize(
    ("data", "text"),
    [
        (shipped("single_helix"), "bends in its plane"),
        (shipped("s_shape"), "zones"),
        (under(BENT, {"hold": {"stretch": 1.01}}, to="20 kPa"), "effects.2.hold"),
        (under(BENT, {"straight": {}}, to="20 kPa"), "no load but a pressure"),
        (BENT | {"model": "body", "mesh": {}}, "expected section or cell"),
        (
            under(BENT, {"blocked-tip": {}}, to="20 kPa") | {"model": "body", "mesh": {}},
            "effects.2.blocked-tip",
        ),
    ],
)
def test_what_it_cannot_have_is_refused_by_name(data: Data, text: str) -> None:
    with pytest.raises(CaseError, match=text):
        refuse(parse_case(data))


def test_a_pressure_from_which_it_is(store: Store) -> None:
    with pytest.raises(CaseError, match="--from: 900 kPa"):
        table_of(checked(BENT), ERROR, 0.9, store)


def test_the_command(
    tmp_path: Path, made: Made, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import yaml

    case = tmp_path / "finger.yaml"
    case.write_text(yaml.safe_dump(BENT), encoding="utf-8")
    monkeypatch.setattr("fiberbend.sectionlaw.table.Store", lambda: None)
    monkeypatch.setattr("fiberbend.sectionlaw.table._made", lambda *_: made)
    monkeypatch.setattr("fiberbend.sectionlaw.store.Store.find", lambda *_: None)
    monkeypatch.setattr("fiberbend.sectionlaw.store.Store.keep", lambda *_: None)
    folder = tmp_path / "law"
    assert main(["table", str(case), "--out", str(folder)]) == 0
    out = capsys.readouterr().out
    assert "free       beside trials" in out
    assert unpacked((folder / "table.npz").read_bytes()).digest == made.digest
    assert (folder / "table.csv").read_text(encoding="utf-8").startswith("stretch,")
    assert (folder / "table.png").stat().st_size > 10_000
    assert main(["table", str(case), "--out", str(folder)]) == 1
    assert "--overwrite" in capsys.readouterr().err
    assert main(["table", str(case), "--error", "40 %"]) == 1
    assert main(["table", str(case), "--from", "3 mm"]) == 1

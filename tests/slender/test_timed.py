"""Cases in time: what is read and refused, rows, balance, valves, files, frequencies."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fiberbend import columns as col
from fiberbend.answer.answer import answer, lines
from fiberbend.case.case import Case
from fiberbend.cli import main
from fiberbend.reader.reader import parse_case
from fiberbend.running.runner import run_case
from fiberbend.schema.problems import CaseError
from fiberbend.slender.frequencies import vibrations
from rod.law import Law
from tests.slender.rods import by_law as by_law
from tests.slender.rods import case, linear, spec

Put = Callable[[Law], None]
RAMP = {"ramp": {"to": "20 kPa", "over": "100 ms"}}
TIME = {"duration": "400 ms", "step": "5 ms", "pressure": RAMP}
WEIGHT = {"gravity": {"direction": "-y"}}
PRESSED = {"pressure": {"to": "20 kPa"}}
BENT = linear((30.0, 400.0))
"""A section that a pressure bends."""


def timed(*effects: dict[str, Any], **changes: Any) -> Case:
    return case(*(effects or (WEIGHT, PRESSED)), time=TIME | changes)


def problems(**changes: Any) -> list[str]:
    with pytest.raises(CaseError) as stop:
        parse_case(spec(WEIGHT, PRESSED, **changes))
    return [str(problem) for problem in stop.value.problems]


# --- what is read ---------------------------------------------------------------------------------


def test_a_case_says_the_same_when_it_is_written() -> None:
    plant = {"plant": {"commands": [{"at": "0 ms", "valve": "fill"}]}}
    for pressure in (
        RAMP,
        plant,
        {"sine": {"mean": "10 kPa", "amplitude": "5 kPa", "frequency": "1 Hz"}},
    ):
        given = timed(pressure=pressure, damping={"retardation_time": "2 ms", "drag": "0.5 1/s"})
        assert parse_case(given.resolved()) == given


def test_every_other_model_refuses_time_by_name() -> None:
    for model in ("analytic", "section", "cell", "body"):
        found = problems(model=model, time=TIME)
        assert any(
            text == f"time: model {model} does not support it: "
            "it knows states at rest only, model rod moves"
            for text in found
        ), found


def test_pressures_of_every_kind() -> None:
    ramp = timed().time
    assert ramp is not None
    assert ramp.pressure.given is not None
    at = ramp.pressure.given.at
    assert [at(t) for t in (0.0, 0.05, 0.1, 1.0)] == pytest.approx([0.0, 0.01, 0.02, 0.02])
    sine = {"sine": {"mean": "10 kPa", "amplitude": "5 kPa", "frequency": "2 Hz"}}
    swings = timed(pressure=sine).time
    assert swings is not None
    assert swings.pressure.given is not None
    assert swings.pressure.given.at(0.125) == pytest.approx(0.015)


def test_a_file_is_read_into_the_case(tmp_path: Path) -> None:
    file = tmp_path / "p.csv"
    file.write_text("t [ms],P [kPa]\n0,0\n100,20\n400,10\n", encoding="utf-8")
    given = timed(pressure={"file": str(file)})
    file.unlink()
    points = parse_case(given.resolved()).time
    assert points is not None
    assert points.pressure.given is not None
    assert points.pressure.given.at(0.25) == pytest.approx(0.015)
    assert points.pressure.points is not None
    assert points.pressure.points.source == "p.csv"


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (
            "t [ms],P [kPa]\n0,0\n100,20\n90,10\n",
            "line 4: 't [ms]' is 90 after 100, expected rising",
        ),
        ("t [ms],P [kPa]\n10,0\n100,20\n", "times begin at 10 ms, expected 0"),
        ("t,P [kPa]\n0,0\n100,20\n", "column 't' has no unit, expected a name such as 't [ms]'"),
        ("t [ms],h [mm]\n0,0\n100,20\n", "no column pressure_kPa"),
        ("t [ms],P [kPa]\n0,0\n", "1 rows, expected from 2 to"),
        (
            "t [ms],P [kPa]\n0,0\n100,5\n",
            'pressures end at "100 ms", expected a duration of no more',
        ),
    ],
)
def test_files_are_checked(tmp_path: Path, rows: str, said: str) -> None:
    file = tmp_path / "p.csv"
    file.write_text(rows, encoding="utf-8")
    (text, *_) = problems(time=TIME | {"pressure": {"file": str(file)}})
    assert said in text


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"step": "1 s"}, 'time.step: "1000 ms", expected at most the duration, "400 ms"'),
        ({"step": "1 us"}, 'time.step: "0.001 ms", expected at least a 100000th of "400 ms"'),
        (
            {"pressure": {"ramp": {"to": "30 kPa", "over": "0 ms"}}},
            'time.pressure.ramp.to: a pressure of "30 kPa", expected from zero to pressure.to, ',
        ),
        (
            {"pressure": {"sine": {"mean": "4 kPa", "amplitude": "5 kPa", "frequency": "1 Hz"}}},
            'time.pressure.sine.mean: a pressure of "-1 kPa", expected from zero to pressure.to',
        ),
        (
            {"pressure": {"sine": {"mean": "10 kPa", "amplitude": "5 kPa", "frequency": "30 Hz"}}},
            'time.step: "5 ms", expected at most a 10th of a period of "30 Hz"',
        ),
        ({"pressure": {}}, "expected one of ramp, sine, file, points, plant"),
        ({"pressure": RAMP | {"file": "p.csv"}}, "ramp and file, expected one of"),
        (
            {"pressure": {"plant": {"commands": [{"at": "1 s", "valve": "fill"}]}}},
            'time.pressure.plant.commands.0.at: "1000 ms", expected below the duration, "400 ms"',
        ),
        ({"damping": {"drag": "-1 1/s"}}, "time.damping.drag"),
        ({"damping": {"drag": "1 ms"}}, 'expected a rate with its unit such as "0.5 1/s"'),
    ],
)
def test_what_has_no_meaning_is_refused(changes: dict[str, Any], said: str) -> None:
    found = problems(time=TIME | changes)
    assert any(said in text for text in found), found


def test_what_is_asked_of_states_at_rest_is_refused() -> None:
    output = {"at_angles": ["10 deg"], "stop_at_angle": "20 deg", "pictures": False}
    found = problems(time=TIME, output=output)
    assert [text.partition(":")[0] for text in found] == [
        "output.at_angles",
        "output.stop_at_angle",
    ]


def test_an_angle_is_no_motion() -> None:
    with pytest.raises(CaseError, match=r"expected pressure.to: motion has a pressure over time"):
        parse_case(spec({"pressure": {"angle": "10 deg"}}, time=TIME))


def test_a_density_is_needed() -> None:
    data = spec(WEIGHT, PRESSED, time=TIME)
    data["effects"] = [PRESSED, data["effects"][-1]]
    assert parse_case(data).time is not None
    del data["materials"]["wall"]["density"]
    with pytest.raises(CaseError, match=r"materials.wall.density: missing, .* for time"):
        parse_case(data)


# --- what it does ---------------------------------------------------------------------------------


def test_rows_by_time_and_a_balance_that_closes(by_law: Put) -> None:
    by_law(BENT)
    found = run_case(timed(damping={"retardation_time": "3 ms", "drag": "0.5 1/s"}), None)
    assert found.status == "converged", found.reason
    times = [row[col.TIME] for row in found.rows]
    np.testing.assert_allclose(times, 0.005 * np.arange(81), atol=1e-12)
    most = max(row[col.KINETIC] for row in found.rows)
    assert max(abs(row[col.DRIFT]) for row in found.rows) < 1e-9 * most
    first, last = found.rows[0], found.rows[-1]
    assert (first[col.SPEED], first[col.AIR_WORK], first[col.PRESSURE]) == (0.0, 0.0, 0.0)
    assert last[col.PRESSURE] == pytest.approx(20.0)
    assert min(last[col.AIR_WORK], last[col.DISSIPATED]) > 0


def test_it_begins_at_rest_and_comes_to_rest_where_the_static_run_ends(by_law: Put) -> None:
    by_law(BENT)
    at_rest = run_case(case(WEIGHT, PRESSED), None).rows[-1]
    found = run_case(
        timed(duration="3 s", damping={"retardation_time": "20 ms", "drag": "20 1/s"}), None
    )
    last = found.rows[-1]
    for key in (col.ANGLE, col.TIP_Y, col.TIP_Z, col.VOLUME):
        assert last[key] == pytest.approx(at_rest[key], rel=1e-4), key
    assert found.run["motion"]["rest_angle_deg"] == pytest.approx(at_rest[col.ANGLE], rel=1e-6)
    # under a constant pressure nothing moves
    still = timed(
        duration="100 ms", pressure={"ramp": {"from": "20 kPa", "to": "20 kPa", "over": "0 s"}}
    )
    angles = [row[col.ANGLE] for row in run_case(still, None).rows]
    assert np.ptp(angles) < 1e-7


def test_a_case_without_time_has_no_mass(by_law: Put) -> None:
    """Neither columns of a motion, nor an entry in run.json."""
    by_law(BENT)
    found = run_case(case(WEIGHT, PRESSED), None)
    assert col.TIME not in found.rows[-1]
    assert "motion" not in found.run


def test_valves_make_the_pressure(by_law: Put) -> None:
    """Filled, held, vented: the air that comes in is what pressure and volume have."""
    by_law(BENT)
    commands = [("0 ms", "fill"), ("60 ms", "hold"), ("200 ms", "vent")]
    plant = {
        "commands": [{"at": at, "valve": valve} for at, valve in commands],
        "supply": "18 kPa",
        "dead_volume": "1 mL",
    }
    given = timed(pressure={"plant": plant}, damping={"retardation_time": "3 ms"})
    found = run_case(given, None)
    assert found.status == "converged", found.reason
    air = [(row[col.PRESSURE] / 1e3 + 0.101325) * (row[col.VOLUME] + 1000.0) for row in found.rows]
    held = [a for row, a in zip(found.rows, air, strict=True) if 0.063 < row[col.TIME] < 0.2]
    assert np.ptp(held) < 1e-6 * held[0]
    assert held[0] > 1.05 * air[0]
    pressures = [row[col.PRESSURE] for row in found.rows]
    assert 5 < max(pressures) <= 18
    # vented it swings about the pressure outside, as far as its own air is pressed
    assert abs(pressures[-1]) < 0.5
    assert max(abs(row[col.DRIFT]) for row in found.rows) < 1e-8


def test_beyond_the_law_it_fails_and_says_when(by_law: Put) -> None:
    class Narrow(type(BENT)):  # type: ignore[misc]
        def outside(self, strains: Any, pressure: float) -> str:
            return "curvature beyond the table" if abs(strains[:, 1]).max() > 0.003 else ""

    by_law(Narrow(BENT.stiffness, BENT.rest, BENT.area, BENT.thrust))
    found = run_case(timed({"pressure": {"to": "20 kPa"}}), None)
    assert found.status == "failed"
    assert "curvature beyond the table; last state: " in found.reason
    assert 2 < len(found.rows) < 80


def test_what_it_leaves_and_answers(tmp_path: Path, by_law: Put) -> None:
    by_law(BENT)
    output = {"pictures": True, "report": True, "animation": True}
    given = case(WEIGHT, PRESSED, time=TIME | {"duration": "100 ms"}, output=output)
    found = run_case(given, tmp_path / "run")
    folder = tmp_path / "run"
    with (folder / "history.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert float(rows[-1]["time_s"]) == pytest.approx(0.1)
    entry = json.loads((folder / "run.json").read_text(encoding="utf-8"))["motion"]
    assert entry["time_s"] == pytest.approx(0.1)
    assert (folder / "pictures" / "over_time.png").stat().st_size > 10_000
    from PIL import Image, ImageSequence

    with Image.open(folder / "pictures" / "animation.gif") as film:
        durations = [frame.info["duration"] for frame in ImageSequence.Iterator(film)]
    # 10 ms from frame to frame of 0.1 s, in real time but for the first and the last one
    assert set(durations[1:-1]) == {10}
    text = "\n".join(lines(answer(given, found.rows, found.run)))
    assert "greatest angle" in text
    assert "at rest under the last pressure" in text
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "energies over time" in page


# --- frequencies ----------------------------------------------------------------------------------


def euler_bernoulli(length: float, bending: float, mass: float) -> list[float]:
    """The first three frequencies of a clamped and free bar, Hz: cos β cosh β = −1."""
    roots = (1.8751040687, 4.6940911330, 7.8547574382)
    return [b * b / (2 * math.pi * length**2) * math.sqrt(bending / mass) for b in roots]


def solid() -> Case:
    """A round bar of solid rubber in all but its chamber, slender, whose caps are short."""
    return case(
        PRESSED,
        time=TIME,
        actuator={
            "section": "circle",
            "radius": "1 mm",
            "length": "200 mm",
            "wall": "1 mm",
            "cap": "1 mm",
        },
        materials={"wall": {"law": "neo-hooke", "mu": "0.3 MPa"}},
        effects=[PRESSED],
    )


def test_frequencies_of_a_slender_bar_are_those_of_euler_and_bernoulli(by_law: Put) -> None:
    """Its section's own EI and mass; within 0.5 %, caps and rotary inertia with them."""
    given = solid()
    outer, inner, young = 2.0, 1.0, 0.9
    bending = young * math.pi / 4 * (outer**4 - inner**4)
    area = math.pi * (outer**2 - inner**2)
    law = linear()
    by_law(type(law)(np.diag([young * area, bending]), np.array([1.0, 0.0])))
    (found,) = vibrations(given, [0.0], 3)
    exact = euler_bernoulli(202.0, bending, 1.1e-9 * area)
    np.testing.assert_allclose(found.frequencies, exact, rtol=5e-3)


def test_the_command_writes_table_and_picture(tmp_path: Path, by_law: Put, capsys: Any) -> None:
    by_law(BENT)
    import yaml

    file = tmp_path / "case.yaml"
    file.write_text(yaml.safe_dump(spec(WEIGHT, PRESSED)), encoding="utf-8")
    out = tmp_path / "out"
    command = ["frequencies", str(file), "--at", "0 kPa", "--at", "10 kPa", "--out", str(out)]
    assert main(command) == 0
    with (out / "frequencies.csv").open(newline="", encoding="utf-8") as table:
        rows = list(csv.DictReader(table))
    assert [row["mode"] for row in rows] == ["1", "2", "3"] * 2
    assert all(float(row["frequency_Hz"]) > 0 for row in rows)
    assert (out / "modes.png").stat().st_size > 10_000
    assert "mode 3" in capsys.readouterr().out
    assert main(command) == 1
    assert main([*command[:2], "--at", "30 kPa", "--out", str(tmp_path / "b")]) == 1
    assert "--at: 30 kPa, expected from 0 to 20 kPa" in capsys.readouterr().err


# --- control --------------------------------------------------------------------------------------


def test_a_plant_with_inertia_swings_about_the_plant_at_rest(by_law: Put) -> None:
    """Filled, then shut and damped: it comes to the angle that its curve has at its pressure."""
    from analytic.control.controller import Valves
    from analytic.control.plant import PlantParameters
    from fiberbend.control.rod_plant import Damping, RodPlant, rod_curve, rod_of

    by_law(BENT)
    rod = rod_of(timed(), math.radians(20))
    curve, ended = rod_curve(rod)
    assert not ended
    parameters = PlantParameters(supply=0.02, dead_volume=1000.0)
    plant = RodPlant(rod, parameters, Damping(0.02, 20.0))
    assert plant.angle == pytest.approx(curve.angle[0], abs=1e-9)
    plant.advance(Valves.FILL, 0.03)
    swings = []
    for _ in range(100):
        plant.advance(Valves.HOLD, 0.01)
        swings.append(plant.angle)
    at_rest = np.interp(plant.pressure, curve.pressure, curve.angle)
    assert plant.angle == pytest.approx(at_rest, abs=2e-3)
    assert max(swings) > 1.02 * plant.angle
    with pytest.raises(ValueError, match="lag: no effect beside the rod's inertia"):
        RodPlant(rod, PlantParameters(lag=0.1), Damping())

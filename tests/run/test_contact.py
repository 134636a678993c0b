"""A short actuator between roof and post, on a table and around a bar: forces and their limits."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from mpi4py import MPI

from fem.march.hooks import AfterStep
from fem.march.records import Ramp, State
from fem.solver.newton import Outcome
from fiberbend import run
from fiberbend.models.choice import meshed
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import as_case
from fiberbend.results.reading import read_history
from fiberbend.running.assembly import assemble
from fiberbend.schema.problems import CaseError
from tests.conftest import MpiRun
from tests.run.conftest import small, write_case

Floats = npt.NDArray[np.float64]

WINDING = {
    "winding": {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar", "as": "smeared"}
}
HELD: dict[str, Any] = {"roof": {}, "post": {}}
GAPS: dict[str, Any] = {"roof": {"gap": "0.2 mm"}, "post": {"gap": "0.2 mm"}}
TABLE: dict[str, Any] = {"plane": {"point": ["0 mm", "-8 mm", "0 mm"], "normal": [0, 1, 0]}}
BAR: dict[str, Any] = {"cylinder": {"center": ["-14 mm", "38 mm"], "radius": "6 mm"}}
OBSTACLES = {"held": ("roof", "post"), "table": ("plane",), "bar": ("cylinder",)}
BALANCE = 1e-6
"""Of the greatest force, and of the greatest moment, on a support."""
YIELD = 2e-3
"""Of a force: what the softness of the obstacles costs at most, as `fiberbend plan` says."""


def _case(contact: dict[str, Any], free: bool = False) -> dict[str, Any]:
    """The short actuator and its obstacles; where it bends before it touches, twice as long."""
    case = small(effects=[{"pressure": {"to": "60 kPa"}}, WINDING, {"contact": contact}])
    case["output"] = {"at_pressures": ["20 kPa", "40 kPa"], "fields": False, "pictures": False}
    if free:
        case["actuator"]["length"] = "48 mm"
        case["mesh"] = {"axial": "6 mm"}
    return case


LONG = pytest.mark.long
NAMES = ["held", "table", pytest.param("bar", marks=LONG)]


@pytest.fixture(scope="module")
def held() -> RunResult:
    """Between roof and post without gaps."""
    return run(_case(HELD))


@pytest.fixture(scope="module")
def table() -> RunResult:
    """Bends onto a table."""
    return run(_case(TABLE, free=True))


@pytest.fixture(scope="module")
def bar() -> RunResult:
    """Bends around a bar."""
    return run(_case(BAR, free=True))


def test_roof_and_post_push_straight(held: RunResult) -> None:
    # the post up, the roof down, and neither along z without friction; the clamp may take either
    # sign, so that only the moment about it says more: the roof is nearer, and pushes harder
    assert held.status == "converged"
    for row in held.rows[1:]:
        assert row["contact_post_y_N"] == row["tip_force_N"] > 0
        assert row["contact_roof_y_N"] == -row["roof_force_N"] < -row["tip_force_N"]
        assert row["contact_post_z_N"] == row["contact_roof_z_N"] == 0


@pytest.mark.parametrize("name", NAMES)
def test_the_clamp_takes_what_obstacles_push(name: str, request: pytest.FixtureRequest) -> None:
    # a closed chamber has no resultant, whatever its pressure
    rows = [row for row in request.getfixturevalue(name).rows if "balance_force" in row]
    assert len(rows) > 1
    for row in rows:
        assert row["balance_force"] < BALANCE
        assert row["balance_moment"] < BALANCE
        for column, part in (("clamp_force_y_N", "y_N"), ("clamp_moment_x_Nmm", "moment_x_Nmm")):
            by = [row[f"contact_{obstacle}_{part}"] for obstacle in OBSTACLES[name]]
            assert row[column] == pytest.approx(-sum(by), abs=BALANCE * np.abs(by).max())


@pytest.mark.parametrize("name", NAMES[1:])
def test_an_obstacle_pushes_once_it_is_touched(name: str, request: pytest.FixtureRequest) -> None:
    # away from itself, and ever harder; before touch not at all
    result, (obstacle,) = request.getfixturevalue(name), OBSTACLES[name]
    assert result.status == "converged"
    gap, up, along = (
        np.array([row[f"contact_{obstacle}_{part}"] for row in result.rows[1:]])
        for part in ("gap_mm", "y_N", "z_N")
    )
    apart = gap > 0
    assert apart.any()
    assert not apart.all()
    assert not np.any([up[apart], along[apart]])
    assert (up[~apart] > 0).all()
    assert (np.diff(up[~apart]) > 0).all()
    if name == "table":
        assert not along.any()
    else:
        # the body rests on the bar's far side
        assert (along[~apart] > 0).all()


@pytest.mark.parametrize("name", NAMES)
def test_nothing_goes_through(name: str, request: pytest.FixtureRequest) -> None:
    # a bar of 12 mm is thinner than the tip's way of 15 mm; what lies inside an obstacle is p/k:
    # some 0.1 MPa on an edge over 7.6 MPa/mm
    for obstacle in OBSTACLES[name]:
        for row in request.getfixturevalue(name).rows[1:]:
            assert row[f"contact_{obstacle}_gap_mm"] > -0.02


@LONG
def test_obstacles_are_stiff_enough(held: RunResult) -> None:
    # an error of first order in 1/k: twice the stiffness takes half of it away (found: 0.06 %)
    stiffness = held.run["contact"]["stiffness_MPa_per_mm"]
    stiff = run(_case(HELD | {"stiffness": f"{2 * stiffness} MPa/mm"}))
    assert stiff.last("tip_force_N") == pytest.approx(held.last("tip_force_N"), rel=YIELD / 2)
    assert stiff.last("tip_force_N") > held.last("tip_force_N")


@pytest.mark.parametrize("name", NAMES[1:])
def test_a_force_starts_from_zero_at_touch(name: str, request: pytest.FixtureRequest) -> None:
    # two lines through two rows each: where the gap closes, and where the force ends; found 0.05
    # and 0.01 kPa apart, what the lines' bend may make of 10 kPa between the rows is a few tenths
    rows, (obstacle,) = request.getfixturevalue(name).rows, OBSTACLES[name]
    columns = [f"contact_{obstacle}_{part}" for part in ("gap_mm", "y_N")]
    gaps = [(r["pressure_kPa"], r.get(columns[0], 7.0)) for r in rows]
    first = next(i for i, (_, gap) in enumerate(gaps) if gap < 0)
    forces = [(r["pressure_kPa"], r[columns[1]]) for r in rows[first : first + 2]]
    met, left = (p - f * (q - p) / (g - f) for (p, f), (q, g) in (gaps[first - 2 : first], forces))
    assert gaps[first - 1][0] < left < forces[0][0]
    assert left == pytest.approx(met, abs=0.3)


def test_a_march_sees_a_touch_coming(table: RunResult) -> None:
    # 20 kPa are asked for, then 40 kPa: a step to there would run 5 mm into the table, flatten the
    # cap onto it and fail; it ends 5 % beyond the way that is left, by a line through two gaps
    pressures = [row["pressure_kPa"] for row in table.rows]
    gaps = [row.get("contact_plane_gap_mm", 7.0) for row in table.rows]
    first = next(i for i, gap in enumerate(gaps) if gap < 0)
    way = gaps[first - 1] / (gaps[first - 2] - gaps[first - 1])
    way *= pressures[first - 1] - pressures[first - 2]
    assert pressures[first] - pressures[first - 1] == pytest.approx(1.05 * way, rel=1e-6)
    assert table.run["cutbacks"] == 0


def test_without_obstacles_a_march_is_left_alone() -> None:
    case = as_case(small(effects=[{"pressure": {"to": "60 kPa"}}, WINDING]))
    built = assemble(case, meshed(case).mesh(case), MPI.COMM_SELF)
    assert built.march.hooks == ()


@LONG
@pytest.mark.parametrize("contact", [GAPS, TABLE], ids=["gaps", "table"])
def test_touch_and_lift_off(contact: dict[str, Any]) -> None:
    """Loaded and unloaded in one march, without a failed step.

    Elastic and without friction: at every pressure the way back is the way there, and at its end
    the body is at rest.
    """
    case = as_case(_case(contact, free=contact is TABLE))
    name = "post" if contact is GAPS else "plane"
    met: list[tuple[float, float, Floats]] = []

    def keep(state: State, _: Outcome) -> None:
        body = built.scene.body
        up = body.node_dofs[body.owned_nodes, 1]
        force = body.symmetry_factor * float(built.scene.force(f"Contact[{name}]")[up].sum())
        met.append((round(state.scalars["pressure"], 9), force, state.w))

    mesh = meshed(case).mesh(case)
    built = assemble(case, mesh, MPI.COMM_SELF)
    stops = (0.01, 0.02, 0.03, 0.04)
    built.ramps[:] = [Ramp("pressure", end, stops=stops) for end in (0.06, 0.0)]
    report = built.march.run(built.ramps, [AfterStep(keep)])
    assert report.status == "converged", report.reason
    assert report.cutbacks == 0
    turned = next(i for i, (pressure, _, _) in enumerate(met) if pressure == 0.06)
    there, back = ({p: (f, w) for p, f, w in part} for part in (met[:turned], met[turned + 1 :]))
    for stop in stops:
        (loaded, w), (unloaded, v) = there[stop], back[stop]
        assert unloaded == pytest.approx(loaded, abs=1e-7)
        assert np.abs(w - v).max() < 1e-7
        assert (loaded > 0) == (contact is GAPS or stop > 0.0225)
    _, force, w = met[-1]
    assert force == 0
    # as exactly as the convergence test asks of forces and volumes
    assert np.abs(w).max() < 1e-8 * case.actuator.length


@LONG
@pytest.mark.mpi
def test_two_ranks_equal_one(held: RunResult, mpirun: MpiRun, tmp_path: Path) -> None:
    # each converges to 1e-10 of the fiber forces, which are some hundred times the tip's
    path = write_case(tmp_path, _case(HELD))
    done = mpirun(2, ["-m", "fiberbend", "run", path, "--out", tmp_path / "run"])
    assert done.returncode == 0, done.stderr
    rows = read_history(tmp_path / "run" / "history.csv")
    assert len(rows) == len(held.rows)
    for one, two in zip(held.rows[1:], rows[1:], strict=True):
        for column in ("angle_deg", "tip_force_N", "roof_force_N", "contact_roof_gap_mm"):
            assert two[column] == pytest.approx(one[column], rel=1e-6), column
        assert max(two["balance_force"] or 1, two["balance_moment"] or 1) < BALANCE


@pytest.mark.parametrize(
    ("contact", "complaint"),
    [
        ({"cylinder": {"center": ["-14 mm", "38 mm"], "radius": "-6 mm"}}, "cylinder.radius: "),
        ({"cylinder": {"center": ["-5 mm", "20 mm"], "radius": "6 mm"}}, "cylinder: reaches 2 mm "),
        (
            {"plane": {"point": ["0 mm", "2 mm", "0 mm"], "normal": [0, 1, 0]}},
            "plane: reaches 3 mm into the actuator at rest, expected room for it",
        ),
        ({"plane": {"point": [0, 0, 0], "normal": [0, 1, 0]}}, "plane.point"),
        (
            {"plane": {"point": ["0 mm", "-8 mm", "0 mm"], "normal": [0, 0, 0]}},
            "plane.normal: [0, 0, 0], expected a direction",
        ),
        ({"post": {"gap": "-1 mm"}}, "post.gap: "),
        ({"roof": {"width": "40 mm"}}, ": roof half width 20 mm: "),
        ({"stiffness": "10 MPa"}, "stiffness: "),
        ({"wall": {}}, "wall: "),
        ({}, ": nothing to touch, expected roof, post, plane or cylinder"),
    ],
)
def test_wrong_obstacles_are_named(contact: dict[str, Any], complaint: str) -> None:
    # a user is told where in the file, and what was expected, before anything is computed
    with pytest.raises(CaseError) as caught:
        as_case(_case(contact))
    lines = str(caught.value).splitlines()
    assert any(
        f"effects.2.contact{'' if complaint[0] == ':' else '.'}{complaint}" in s for s in lines
    )


def test_roof_and_post_hold_or_push_but_not_both() -> None:
    case = _case(HELD)
    case["effects"].append({"blocked-tip": {}})
    with pytest.raises(CaseError, match=r"effects\.2\.contact\.roof: effects\.3\.blocked-tip has"):
        as_case(case)


@pytest.mark.parametrize("model", ["analytic", "section", "cell"])
def test_obstacles_need_a_body(model: str) -> None:
    case = _case(HELD) | {"model": model}
    case["mesh"], case["output"] = {}, {}
    with pytest.raises(
        CaseError, match=r"effects\.2\.contact: model \w+ does not support it: obstacles"
    ):
        as_case(case)

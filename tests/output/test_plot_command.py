"""`fiberbend plot`: curves of runs, sweeps and measured points in one figure for a paper."""

from __future__ import annotations

import csv
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fiberbend
from fiberbend import columns as col
from fiberbend.api.plot import PAPER, Plot, plot, select, write
from fiberbend.api.runs import RunData, axis_label
from fiberbend.cli import main
from fiberbend.reader.yaml_file import load_yaml
from fiberbend.results.reading import read_history
from fiberbend.schema.problems import CaseError
from fiberbend.sweep.command import run_sweep
from tests.conftest import ROOT
from tests.output.test_curves import contact_rows, covered
from tests.output.test_styles import size_of


def case(**changes: Any) -> dict[str, Any]:
    """A quick case of the closed form."""
    data: dict[str, Any] = load_yaml(ROOT / "cases" / "section.yaml")
    data |= {"model": "analytic", "output": {"pictures": False, "fields": False, "report": False}}
    data["actuator"] |= changes.pop("actuator", {})
    return data | changes


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folders: thin, thick and blocked."""
    folder = tmp_path_factory.mktemp("runs")
    fiberbend.run(case(), folder / "thin")
    fiberbend.run(case(actuator={"wall": "3 mm"}), folder / "thick")
    blocked = load_yaml(ROOT / "cases" / "blocked_tip.yaml") | {"model": "analytic"}
    blocked["output"] = {"pictures": False, "fields": False, "report": False}
    for effect in blocked["effects"]:
        effect.get("winding", {})["as"] = "smeared"
    fiberbend.run(blocked, folder / "blocked")
    return folder


@pytest.fixture(scope="module")
def sweep(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep over wall and radius."""
    folder = tmp_path_factory.mktemp("sweeps")
    import yaml

    data = {
        "title": "Walls",
        "case": case(),
        "vary": {"actuator.wall": ["2 mm", "3 mm"], "actuator.radius": ["7 mm", "8 mm"]},
        "report": {"angles": ["90 deg"], "maps": []},
    }
    (folder / "walls.yaml").write_text(yaml.safe_dump(data, sort_keys=False))
    assert run_sweep(folder / "walls.yaml", folder / "walls", (), 1, False, False) == 0
    return folder / "walls"


def refusal(*arguments: Any, **options: Any) -> str:
    with pytest.raises(CaseError) as caught:
        select(*arguments, **options)
    return str(caught.value)


def history(folder: Path, *names: str) -> list[list[float]]:
    rows = read_history(folder / "history.csv")
    return [[row[name] for row in rows] for name in names]  # type: ignore[misc]


def test_a_run_shows_angle_over_pressure_and_a_blocked_one_its_force(runs: Path) -> None:
    shown = select(runs / "thin")
    assert (shown.x, shown.y, shown.name) == ((col.PRESSURE,), (col.ANGLE,), "pressure_angle")
    (curve,) = shown.curves
    assert [list(curve.across), list(curve.up)] == history(
        runs / "thin", "pressure_kPa", "angle_deg"
    )
    shown = select(runs / "blocked")
    assert (shown.y, shown.name) == ((col.TIP_FORCE,), "pressure_tip_force")
    axes = shown.draw(PAPER).axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("pressure P (kPa)", "tip force (N)")
    assert axes.get_legend() is None


def test_a_run_that_touches_something_shows_the_force_of_it() -> None:
    force = np.array([0.0, 0, 0, 1, 2, 3, 4])
    rows = contact_rows(contact_bar_y_N=3 * force, contact_bar_z_N=4 * force)
    shown = select(RunData("grasp", {}, rows))
    assert shown.y == ("contact_bar_force_N",)
    assert list(shown.curves[0].up) == pytest.approx(5 * force)
    axes = shown.draw(PAPER).axes[0]
    assert axes.get_ylabel() == "force of the bar (N)"
    never = contact_rows(contact_bar_y_N=0 * force, contact_bar_z_N=0 * force)
    assert select(RunData("missed", {}, never)).y == (col.ANGLE,)


def test_a_run_at_one_pressure_is_shown_over_its_load_steps() -> None:
    rows = [{**row, col.PRESSURE: 0.0} for row in contact_rows()]
    shown = select(RunData("hanging", {}, rows))
    assert (shown.x, shown.name) == ((col.STEP,), "step_angle")
    assert list(shown.curves[0].across) == [row[col.STEP] for row in rows]


@pytest.mark.parametrize("kind", ["pdf", "svg", "png"])
def test_the_command_writes_a_figure_of_exactly_85_mm(
    kind: str, runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = tmp_path / f"figure.{kind}"
    folders = [str(runs / "thin"), str(runs / "thick")]
    assert main(["plot", *folders, "--width", "85mm", "--out", str(target)]) == 0
    width, height = size_of(target.read_bytes(), kind)
    assert width == pytest.approx(85, abs=0.1 if kind == "png" else 1e-4)
    assert height == pytest.approx(59.5, abs=0.1 if kind == "png" else 1e-4)
    assert capsys.readouterr().out == f"{target}: 85 mm × 59.5 mm, 2 curves\n"


def test_the_figure_stands_by_its_run_or_in_the_working_folder(
    runs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(runs / "thin", tmp_path / "thin")
    shutil.copytree(runs / "thick", tmp_path / "thick")
    monkeypatch.chdir(tmp_path)
    before = {path.name: path.read_bytes() for path in (tmp_path / "thin").glob("*.*")}
    assert main(["plot", "thin"]) == 0
    assert main(["plot", "thin", "thick", "--format", "svg"]) == 0
    after = {path.name: path.read_bytes() for path in (tmp_path / "thin").glob("*.*")}
    assert {*after} - {*before} == {"pressure_angle.pdf"}
    assert {name: after[name] for name in before} == before
    assert [path.name for path in tmp_path.glob("*.*")] == ["pressure_angle.svg"]


def test_files_of_a_run_are_never_replaced(runs: Path, tmp_path: Path) -> None:
    run = tmp_path / "run"
    shutil.copytree(runs / "thin", run)
    (run / "pictures").mkdir(exist_ok=True)
    for name in ("pictures/pressure_angle.png", "pictures/tip_new.png", "control.png"):
        (run / name).write_text("mine")
        with pytest.raises(CaseError, match="is a file of the run"):
            plot(run, target=run / name, style=PAPER)
        assert (run / name).read_text() == "mine"
    plot(run, target=run / "pictures" / "figure.png")
    plot(run, target=run / "pressure_angle.pdf")
    with pytest.raises(CaseError, match="Is a directory"):
        plot(run, target=run / "pictures")


def test_runs_are_named_by_what_differs_between_their_cases(runs: Path) -> None:
    shown = select([runs / "thin", runs / "thick"])
    assert [curve.label for curve in shown.curves] == ["wall 2 mm", "wall 3 mm"]
    axes: Any = shown.draw(PAPER).axes[0]
    assert covered(axes) == []
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["wall 2 mm", "wall 3 mm"]
    shown = select([runs / "thin", runs / "thick"], labels=["ours"])
    assert [curve.label for curve in shown.curves] == ["ours", "wall 3 mm"]
    assert "3 labels" in refusal([runs / "thin", runs / "thick"], labels=["a", "b", "c"])


@pytest.mark.parametrize(
    ("cases", "expected"),
    [
        ([{"title": "One"}, {"title": "Two"}], ["One", "Two"]),
        (
            [{"title": "One", "model": "section"}, {"model": "body"}],
            ["section model", "body model"],
        ),
        ([{"sheath": "1 mm"}, {}], ["sheath 1 mm", "no sheath"]),
        (
            [{"a": {"wall": "1 mm", "x": 1, "yy": 1}, "title": "One"}, {"title": "Two"}],
            ["One", "Two"],
        ),
        ([{"title": "One"}, {"title": "One"}], ["run0", "run1"]),
        ([{"output": {"fields": True}}, {"output": {"fields": False}}], ["run0", "run1"]),
    ],
)
def test_names_of_runs(cases: list[dict[str, Any]], expected: list[str]) -> None:
    runs = [RunData(f"run{i}", case, contact_rows()) for i, case in enumerate(cases)]
    assert [curve.label for curve in select(runs).curves] == expected


def test_many_curves_are_told_apart() -> None:
    runs = [RunData(f"run{i}", {}, contact_rows()) for i in range(28)]
    lines = select(runs).draw(PAPER).axes[0].lines
    assert len({(line.get_color(), line.get_linestyle()) for line in lines}) == 28


def test_runs_in_folders_of_one_name_are_counted() -> None:
    same = [RunData("run", {}, contact_rows()) for _ in range(2)]
    assert [curve.label for curve in select(same).curves] == ["1: run", "2: run"]


def test_any_column_over_any_other(runs: Path) -> None:
    shown = select(runs / "thin", x="tip_z_mm", y="tip_y_mm")
    assert [list(shown.curves[0].across), list(shown.curves[0].up)] == history(
        runs / "thin", "tip_z_mm", "tip_y_mm"
    )
    shown = select([runs / "thin", runs / "thick"], y=["tip_z_mm", "tip_y_mm"])
    assert [curve.label for curve in shown.curves] == [
        f"wall {wall} mm, tip {axis}" for wall in (2, 3) for axis in "zy"
    ]
    assert shown.draw(PAPER).axes[0].get_ylabel() == "length (mm)"
    assert select(runs / "thin", y="pressure_kPa").x == (col.ANGLE,)


def test_a_run_beside_other_models(runs: Path) -> None:
    names = ["pressure_kPa", "analytic_winding_kPa"]
    shown = select(runs / "thin", x=names)
    assert [curve.label for curve in shown.curves] == ["analytic", "analytic winding"]
    assert shown.name == "pressure_angle"
    assert [list(curve.across) for curve in shown.curves] == history(runs / "thin", *names)
    text = refusal(runs / "thin", x=["pressure_kPa", "tip_y_mm"], y="angle_deg")
    assert text == "x: pressure_kPa in kPa, tip_y_mm in mm, expected columns of one unit"


def test_axes_have_units() -> None:
    labels = {
        col.PRESSURE: "pressure P (kPa)",
        col.ANGLE: "bending angle θ (°)",
        col.VOLUME: "chamber volume (mm³)",
        col.MOMENT: "moment kept straight (N mm)",
        col.STEP: "load step",
        "tip_y_mm": "tip y (mm)",
        "axis_stretch": "axis stretch",
        "contact_bar_area_mm2": "contact bar area (mm²)",
        "pressure_360deg_kPa": "pressure at 360° (kPa)",
        "zero_fit_angle_-4.5kPa_deg": "zero fit angle at -4.5 kPa (°)",
        "wall_mm": "wall (mm)",
    }
    assert {name: axis_label(name) for name in labels} == labels


def test_what_cannot_be_drawn_is_refused(runs: Path, tmp_path: Path) -> None:
    thin = runs / "thin"
    text = refusal(thin, y="angel_deg")
    assert text.startswith('y: "angel_deg", no such column in the history of thin; did you mean ')
    assert "angle_deg" in text.partition("Expected one of")[2]
    # not of this run, though there is such a column
    assert 'x: "twist_deg", no such column' in refusal(thin, x="twist_deg")
    assert "tip_force_N" in refusal([runs / "blocked", thin], y="tip_force_N")
    text = refusal([runs / "blocked", thin])
    assert text.startswith("y: not given, the runs lead with tip_force_N (blocked) and angle_deg (")
    text = refusal(thin, y=["angle_deg", "tip_y_mm"])
    assert text == "y: angle_deg in °, tip_y_mm in mm, expected columns of one unit"
    for folder, found in (("nowhere", "no such folder"), ("empty", "contains no run")):
        (tmp_path / "empty").mkdir(exist_ok=True)
        path = tmp_path / folder
        wanted = "expected the folder of a run or of a sweep"
        assert refusal(path) == f"{path}: {found}, {wanted}"
    file = runs / "thin" / "history.csv"
    assert refusal(file) == f"{file}: is a file, expected the folder of a run or of a sweep"
    (tmp_path / "begun").mkdir()
    shutil.copy(thin / "case.resolved.yaml", tmp_path / "begun")
    assert "contains no history.csv" in refusal(tmp_path / "begun")
    (tmp_path / "begun" / "history.csv").write_text("pressure_kPa,angle_deg\n1,x\n")
    assert f"{tmp_path}/begun/history.csv" in refusal(tmp_path / "begun")
    assert "none, expected the folder" in refusal([])


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--out", "figure.gif"], '--out: "figure.gif", expected an ending .pdf, .svg or .png'),
        (["--out", "figure.svg", "--format", "pdf"], '--out: "figure.svg", expected .pdf'),
        (["--width", "5 mm"], '--width: "5 mm", expected a length from 20 mm to 2000 mm'),
        (["--width", "wide"], '--width: "wide", expected a length with its unit'),
        (["--dpi", "0"], "--dpi: 0, expected 20 to 2400 dots per inch"),
        (["--font-size", "nan"], "--font-size: nan, expected 2 to 72 pt"),
        (["--height", "20 mm", "--font-size", "30"], "size: 85 mm × 20 mm at 30 pt: no room"),
        (["--format", "jpg"], "jpg"),
    ],
)
def test_options_that_cannot_be_used_are_refused_and_nothing_is_written(
    options: list[str],
    words: str,
    runs: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    try:
        code = main(["plot", str(runs / "thin"), *options])
    except SystemExit as stop:
        code = stop.code  # type: ignore[assignment]
    assert code == 1
    assert words in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
    assert not list(runs.glob("thin/*.pdf"))


def test_measured_points_lie_where_they_were_measured(runs: Path, tmp_path: Path) -> None:
    file = tmp_path / "mine.csv"
    file.write_text("note,pressure_kPa,angle_deg\na,10,21\nb,20,43.5\n")
    shown = select(runs / "thin", measured=file)
    curve = shown.curves[-1]
    assert (curve.label, curve.measured) == ("measured", True)
    assert list(curve.across) == pytest.approx([10, 20], rel=1e-14)
    assert list(curve.up) == pytest.approx([21, 43.5], rel=1e-14)
    line = shown.draw(PAPER).axes[0].lines[-1]
    assert (line.get_linestyle(), line.get_marker()) == ("None", "x")
    # the other way round, and by other columns
    shown = select(runs / "thin", x="angle_deg", y="pressure_kPa", measured=file)
    assert list(shown.curves[-1].across) == pytest.approx([21, 43.5])
    file.write_text("tip_y_mm,tip_z_mm\n-3,4\n")
    shown = select(runs / "thin", x="tip_z_mm", y="tip_y_mm", measured=[file, file])
    assert [(c.label, c.across, c.up) for c in shown.curves[1:]] == 2 * [
        ("measured, mine", (4.0,), (-3.0,))
    ]


def test_measured_points_that_are_none_are_refused(runs: Path, tmp_path: Path) -> None:
    file = tmp_path / "mine.csv"
    for x, y in ((col.PRESSURE, col.ANGLE), ("tip_z_mm", "tip_y_mm")):
        text = refusal(runs / "thin", x=x, y=y, measured=tmp_path / "none.csv")
        assert "no such file" in text
        file.write_text("pressure_kPa,other\n1,2\n")
        text = refusal(runs / "thin", x=x, y=y, measured=file)
        assert text.startswith(f"{file}: ")
        assert "expected" in text


def test_points_of_a_sweep_are_curves(sweep: Path) -> None:
    shown = select(sweep)
    assert [curve.label for curve in shown.curves] == [
        f"radius {radius} mm, wall {wall} mm" for wall in (2, 3) for radius in (7, 8)
    ]
    point = sweep / "points" / "wall-3mm_radius-7mm"
    assert list(shown.curves[2].across) == history(point, "pressure_kPa")[0]


def test_columns_of_a_sweep_over_each_other(sweep: Path) -> None:
    shown = select(sweep, x="wall_mm", y="pressure_90deg_kPa")
    assert [curve.label for curve in shown.curves] == ["radius 7 mm", "radius 8 mm"]
    with (sweep / "sweep.csv").open(newline="") as file:
        table = {
            (float(row["wall_mm"]), float(row["radius_mm"])): float(row["pressure_90deg_kPa"])
            for row in csv.DictReader(file)
        }
    for radius, curve in zip((7.0, 8.0), shown.curves, strict=True):
        assert list(curve.across) == [2.0, 3.0]
        assert list(curve.up) == [table[wall, radius] for wall in (2.0, 3.0)]
    # without x over the field that varies first
    assert select(sweep, y="pressure_90deg_kPa").x == ("wall_mm",)
    assert "did you mean wall_mm" in refusal(sweep, x="wal_mm", y="pressure_90deg_kPa")


def test_a_run_has_no_column_of_a_sweep(sweep: Path, runs: Path) -> None:
    text = refusal([sweep, runs / "thin"], x="wall_mm", y="pressure_90deg_kPa")
    assert text.startswith("thin: is a run")


def test_a_sweep_that_has_not_ended_shows_the_points_that_it_has(
    sweep: Path, tmp_path: Path
) -> None:
    shutil.copytree(sweep, tmp_path / "walls")
    (tmp_path / "walls" / "sweep.csv").unlink()
    shutil.rmtree(tmp_path / "walls" / "points" / "wall-3mm_radius-8mm")
    assert len(select(tmp_path / "walls").curves) == 3
    shutil.rmtree(tmp_path / "walls" / "points")
    (tmp_path / "walls" / "points").mkdir()
    assert "no point is solved" in refusal(tmp_path / "walls")


def test_from_python(runs: Path, tmp_path: Path) -> None:
    figure = plot([runs / "thin", str(runs / "thick")], target=tmp_path / "figure.pdf")
    assert size_of((tmp_path / "figure.pdf").read_bytes(), "pdf") == pytest.approx((85, 59.5))
    assert len(figure.axes[0].lines) == 2
    shown = select(runs / "thin")
    assert isinstance(shown, Plot)
    write(shown.draw(PAPER), tmp_path / "new" / "figure.pdf", PAPER)
    assert (tmp_path / "new" / "figure.pdf").stat().st_size > 5000


def test_a_title_of_a_user_is_text(tmp_path: Path) -> None:
    cases: Sequence[dict[str, Any]] = [{"title": r"$\frac{broken$"}, {"title": "🐍 & <b>" * 20}]
    runs = [RunData("run", case, contact_rows()) for case in cases]
    figure: Any = plot(runs, target=tmp_path / "figure.pdf")
    texts = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert texts[0] == r"\$\frac{broken\$"
    assert len(texts[1]) <= 65
    assert " … " in texts[1]


def test_open_shows_the_figure(runs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[Path] = []
    monkeypatch.setattr("fiberbend.commands.opening.open_file", shown.append)
    target = tmp_path / "figure.png"
    assert main(["plot", str(runs / "thin"), "--out", str(target), "--open"]) == 0
    assert shown == [target]

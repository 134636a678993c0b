"""`make paper`: its verdicts, and a page of all stated numbers that needs no network."""

from __future__ import annotations

import dataclasses
import html
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from bench.paper import __main__ as paper
from bench.paper import verdict as v
from bench.paper.facts import ANGLES, BASELINE, FIG_8, FIG_10, FIG_11, STATED, TABLE_I, by_key
from bench.paper.figures import fig11, fig13
from bench.paper.lines import force, kpa, printed, zero_fit
from bench.paper.lines import paper as closed_form
from bench.paper.page import PIXELS, Made, markdown, missing, sentence
from bench.paper.part import Found, Part, Table
from bench.paper.parts import PARTS
from bench.paper.runs import Curve, Key, Runs, Solved
from tests.conftest import ROOT

NOT_HERE = "https?://"
CHROMIUM = Path("/usr/bin/chromium")


def curve(key: Key, folder: Path, model: str) -> Curve:
    """What a run might have left, with the pressures of (19)."""
    angles = np.linspace(0.0, 360.0, 37)
    pressures = kpa(closed_form(key), angles)
    rows = [
        {
            "pressure_kPa": p,
            "angle_deg": a,
            "tip_z_mm": 160 - a / 10,
            "tip_y_mm": 5 - a / 10,
            "chamber_mm3": 16000 + 30 * a,
        }
        for p, a in zip(pressures.tolist(), angles.tolist(), strict=True)
    ]
    run = {"elements": 72, "unknowns": 882, "load_steps": 36, "newton_iterations": 50}
    place = folder / f"{model}_{'_'.join(f'{x:g}' for x in key)}"
    place.mkdir(parents=True)
    np.savez(place / "mesh.npz", nodes=np.zeros((100, 3)))
    return Curve(rows, run | {"wall_s": {"solve": 1.0}}, place)


@dataclasses.dataclass
class Known(Runs):
    """Runs that solve nothing."""

    def solve(self, model: str, name: str, out: str, _settings: Sequence[str] = ()) -> Solved:
        """Table I or Fig. 11 by closed forms."""
        if name.startswith("fig11"):
            return self._forces(name)
        keys = [size.key for size in TABLE_I]
        table = [
            {
                "radius_mm": a,
                "length_mm": length,
                "wall_mm": t,
                "greatest_stretch": 1.6,
                "blocked_force_N": float(force(closed_form((a, length, t)), 100.0)),
            }
            for a, length, t in keys
        ]
        curves = [curve(key, self.folder / out, model) for key in keys]
        return Solved(model, curves, table, f"a command of {name}")

    def _forces(self, name: str) -> Solved:
        curves, table = [], []
        kinds = ("section", "cell") if name == "fig11_straight.yaml" else ("held", "pushed")
        for kind in kinds:
            for a, length, t in FIG_11:
                at = np.linspace(0.0, 250.0, 6)
                forces = force(closed_form((a, length, t)), at)
                rows = [
                    {"pressure_kPa": p, "blocked_moment_Nmm": 30 * f, "tip_force_N": 1.05 * f}
                    for p, f in zip(at.tolist(), forces.tolist(), strict=True)
                ]
                run: dict[str, Any] = {"contact": {}} if kind == "pushed" else {}
                curves.append(Curve(rows, run, self.folder))
                table.append({"model": kind, "radius_mm": a, "length_mm": length})
        return Solved("forces", curves, table, f"a command of {name}")

    @property
    def whole_thread(self) -> Curve:  # type: ignore[override]
        """That of a cell."""
        return self.cell.sizes[BASELINE]

    @property
    def pictures(self) -> Path:  # type: ignore[override]
        """Two small pictures."""
        from PIL import Image

        for name in ("rest.png", "bent.png"):
            Image.new("RGB", (140, 60), "red").save(self.folder / name)
        return self.folder


@pytest.fixture(scope="module", params=[False, True], ids=["quick", "full"])
def page(request: Any, tmp_path_factory: Any) -> tuple[Path, list[Made]]:
    out = tmp_path_factory.mktemp("paper")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fig13, "NOISES", (0.0, 1.0))
        patch.setattr(fig13, "SEEDS", range(2))
        made = paper.make(Known(out, bodies=request.param), out)
    return out / "index.html", made


def test_every_stated_number_is_on_the_page_with_a_verdict(page: tuple[Path, list[Made]]) -> None:
    path, made = page
    text = html.unescape(path.read_text(encoding="utf-8"))
    for fact in STATED.values():
        assert fact.printed in text, fact.key
        assert fact.place in text, fact.key
    assert missing(made) == []
    assert sentence(made) in text
    for each in made:
        for verdict in each.found.verdicts:
            assert verdict.ours in text
            assert verdict.why
    short = dataclasses.replace(made[0], found=Found())
    assert "easiest" in missing([short, *made[1:]])


def test_a_number_without_a_verdict_is_refused(tmp_path: Path, monkeypatch: Any) -> None:
    parts = (Part("empty", "Nothing", lambda _runs: Found()),)
    monkeypatch.setattr(paper, "PARTS", parts)
    with pytest.raises(ValueError, match="no verdict on length"):
        paper.make(Known(tmp_path), tmp_path, parts)


def test_the_page_needs_no_network(page: tuple[Path, list[Made]]) -> None:
    text = page[0].read_text(encoding="utf-8")
    assert not re.search(rf"""(?:src|data|srcset)\s*=\s*["']?{NOT_HERE}""", text)
    assert not re.search(r"<link|@import|url\(|<script[^>]+src|<iframe", text)
    for link in re.findall(rf'href="({NOT_HERE}[^"]+)"', text):
        assert link.startswith("https://doi.org/")
    assert "default-src 'none'" in text
    assert text.count("<img ") == sum(len(each.found.figures) for each in page[1])


def test_figures_are_files_and_the_page_says_how_they_are_made(
    page: tuple[Path, list[Made]],
) -> None:
    path, made = page
    figures = [figure.name for each in made for figure in each.found.figures]
    assert {"fig4", "fig6", "fig8", "fig9", "fig10", "fig11", "fig13"} <= set(figures)
    for name in figures:
        for ending in ("png", "pdf"):
            assert (path.parent / "figures" / f"{name}.{ending}").stat().st_size > 1000
    text = html.unescape(path.read_text(encoding="utf-8"))
    for each in made:
        assert f"python -m bench.paper --only {each.name}" in text
        for figure in each.found.figures:
            assert figure.page.get_size_inches()[0] * 100 == pytest.approx(PIXELS)


def test_the_text_of_figures_is_read_at_its_size(page: tuple[Path, list[Made]]) -> None:
    from matplotlib.text import Text

    for each in page[1]:
        for figure in each.found.figures:
            sizes = [
                text.get_fontsize()
                for text in figure.page.findobj(Text)
                if text.get_text().strip() and text.get_visible()
            ]
            assert min(sizes, default=10) >= 10, figure.name


def test_the_page_in_a_browser(page: tuple[Path, list[Made]]) -> None:
    library = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if not CHROMIUM.exists():
        pytest.skip(f"{CHROMIUM} is not there (apt-get install chromium)")
    with library.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=str(CHROMIUM), args=["--no-sandbox"])
        opened = browser.new_page(viewport={"width": 1280, "height": 900})
        said: list[str] = []
        asked: list[str] = []
        opened.on("console", lambda message: said.append(message.text))
        opened.on("request", lambda request: asked.append(request.url))
        opened.goto(page[0].as_uri())
        images = opened.evaluate(
            "[...document.images].map(i => [i.naturalWidth, i.getBoundingClientRect().width])"
        )
        wide = opened.evaluate("document.documentElement.scrollWidth")
        browser.close()
    assert said == []
    assert [url for url in asked if not url.startswith(("file:", "data:"))] == []
    # at 100 %, and twice as fine for sharp screens
    assert len(images) >= 7
    assert all(image == [2 * PIXELS, PIXELS] for image in images)
    assert wide == 1280


def test_docs_have_every_stated_number() -> None:
    text = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
    for fact in STATED.values():
        assert fact.printed in text, fact.key
    for part in PARTS:
        assert f"## {part.title}" in text
    for image in re.findall(r"\(images/(paper_\w+\.png)\)", text):
        assert (ROOT / "docs" / "images" / image).exists()


def test_markdown_is_that_of_the_parts(page: tuple[Path, list[Made]]) -> None:
    text = markdown(page[1], "a form")
    judged = [each for each in page[1] if each.found.verdicts]
    assert text.count("| verdict | because |") == len(judged)
    assert "a form" in text


def test_facts_are_printed_as_they_are_valued() -> None:
    for fact in STATED.values():
        if math.isnan(fact.value) or not re.search(r"\d", fact.printed):
            continue
        first = re.search(r"\d[\d, ]*(?:\.\d+)?", fact.printed)
        assert first is not None
        number = float(re.sub("[, ]", "", first[0]))
        scale = 100 if fact.printed.endswith("%") else 1
        if fact.key in ("halved", "twice", "share", "stretch", "hoop"):
            continue
        assert number == pytest.approx(scale * fact.value), fact.key
    with pytest.raises(ValueError, match="two facts are 'radius'"):
        by_key([STATED["radius"], STATED["radius"]])


def test_sizes_are_those_of_the_shipped_sweeps() -> None:
    sizes = {size.key for size in TABLE_I}
    assert BASELINE in sizes
    assert {tuple(map(float, key)) for key in (*FIG_10, *FIG_11)} <= sizes
    for name in ("table1", "table1_cell", "table1_body", "table1_floor3"):
        file = yaml.safe_load((ROOT / "cases/sweeps" / f"{name}.yaml").read_text(encoding="utf-8"))
        points = [
            tuple(float(point[f"actuator.{field}"].split()[0]) for field in FIG_8)
            for point in file["points"]
        ]
        assert points == [size.key for size in TABLE_I], name


def test_closed_forms_are_those_of_the_paper() -> None:
    # worked out independently of this project
    found = kpa(closed_form(BASELINE), np.array([90.0, 180.0, 270.0, 360.0]))
    assert found == pytest.approx([78.197, 140.691, 192.815, 237.828], abs=0.001)
    assert float(kpa(printed(), 360.0)) == pytest.approx(38052.6, abs=1)
    assert float(force(closed_form(BASELINE), 200.0)) == pytest.approx(7.23, abs=0.005)
    # nothing of it is fitted: rubbers and sheath alone
    assert zero_fit(BASELINE).sheath == STATED["sheath"].value
    assert float(kpa(zero_fit(BASELINE), 360.0)) == pytest.approx(204.55, abs=0.01)


@pytest.mark.parametrize(
    ("ours", "kept"), [(196.0, True), (217.3, True), (217.5, False), (174.0, False)]
)
def test_near(ours: float, kept: bool) -> None:
    assert v.near("full_circle", "cell", ours, 0.109, "a bound").kept is kept


def test_what_a_run_does_not_reach_is_no_verdict() -> None:
    for found in (
        v.near("full_circle", "cell", math.nan, 0.109, "a bound"),
        v.trend("wall_pressure", "cell", (1.0, math.nan), "1, 2 mm"),
        v.possible("pressure", ("a", "b"), (math.nan, 1.0), (0.1, 0.1), "there"),
    ):
        assert found.word == "cannot be compared"
        assert found.why == v.UNREACHED


def test_rounded_and_within() -> None:
    assert v.rounded("half_a", "geometry", 0.5886).kept
    assert not v.rounded("full_a", "geometry", 0.8142).kept
    assert v.rounded("half_width", "geometry", 1.5958).kept
    assert v.within("delay", "loop", 69.9, 10.0, "a period").kept
    assert not v.within("delay", "loop", 49.9, 10.0, "a period").kept
    assert v.used("cap", 15.0, "a case").taken
    assert v.used("cap", 14.0, "a case").word == "not kept"


@pytest.mark.parametrize(
    ("values", "sign"),
    [
        ((1.0, 2.0, 3.0), "↑"),
        ((3.0, 2.0, 1.0), "↓"),
        ((1.0, 1.005, 0.998), "—"),
        ((2.0, 1.0, 2.5), "∪"),
        ((1.0, 2.0, 1.0), "∩"),
    ],
)
def test_signs(values: tuple[float, ...], sign: str) -> None:
    assert v.sign_of(values) == sign
    found = v.trend("radius_pressure", "cell", values, "three radii")
    assert found.kept is (sign == "↓")


def test_errors_against_points_that_are_not_published() -> None:
    # the paper's own two models at 360°
    found = v.possible("pressure", ("(19)", "FE"), (237.828, 196.0), (0.109, 0.109), "at 360°")
    assert found.kept is None
    assert "214.5 to 220" in found.why
    low, high = v.shared((237.828, 196.0), (0.109, 0.109))
    for measured in (low, high):
        assert max(abs(x / measured - 1) for x in (237.828, 196.0)) <= 0.109 + 1e-12
    apart = v.possible("pressure", ("(19)", "cell"), (237.8, 181.5), (0.109, 0.109), "at 360°")
    assert apart.kept is False


def test_a_lever_arm_that_leaves_room_for_both_errors() -> None:
    of = {key: [1.0] * 5 for key in fig11.KEYS}
    every = {"eq. (20)": of, fig11.HELD: {key: [1.0, 1.0, 1.05, 1.1, 1.1] for key in fig11.KEYS}}
    low, high = fig11.levers(every, fig11.HELD)
    for lever, part in ((low, 1.0), (high, 1.1)):
        # at its ends a measured force is just between (20) and the body
        ends = v.shared((15.0 / lever, part), fig11.ERRORS)
        assert ends[0] == pytest.approx(ends[1])
    assert low < 15 < high


def test_places_that_no_measured_one_is_near() -> None:
    rest, error = np.zeros(2), 0.037
    first = np.array([[100.0, 0.0]])
    # on a line the balls are the intervals of `shared`
    for part, kept in ((1.07, None), (1.08, False)):
        low, high = v.shared((100.0, 100.0 * part), (error, error))
        assert (low <= high) is (kept is None)
        found = v.possible_place(
            "path", ("arc", "cell"), first, part * first, rest, error, np.array([90.0])
        )
        assert found.kept is kept
        assert "at 90°" in found.ours


def test_a_table_has_as_many_cells_as_its_head() -> None:
    with pytest.raises(ValueError, match="1 cells, 2 expected"):
        Table("a table", ("one", "two"), [["only"]])


def test_a_sweep_is_solved_once_and_its_angles_are_read(tmp_path: Path, monkeypatch: Any) -> None:
    from bench.paper import runs

    file = yaml.safe_load((ROOT / "cases/sweeps/table1.yaml").read_text(encoding="utf-8"))
    file["points"] = file["points"][6:7]
    file["case"] = str(ROOT / "cases" / "free_bending_smeared.yaml")
    (tmp_path / "one.yaml").write_text(yaml.safe_dump(file), encoding="utf-8")
    monkeypatch.setattr(runs, "SWEEPS", tmp_path)
    for _ in range(2):
        done = Runs(tmp_path, jobs=1).solve("section", "one.yaml", "one", ["mesh.section=1"])
        found = done.sizes[BASELINE]
        assert [found.at_angle(a) for a in ANGLES] == pytest.approx([45.2, 89.3, 181.9], rel=0.01)
        assert math.isnan(found.at_angle(400.0))
        assert done.number(BASELINE, "blocked_force_N") == pytest.approx(6.3, abs=0.1)
        written = (found.folder / "run.json").stat().st_mtime_ns
    assert (found.folder / "run.json").stat().st_mtime_ns == written
    assert "--set 'mesh.section=1'" in done.command

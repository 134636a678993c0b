"""Columns of history.csv: what the table does not have is not written; docs say the same."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import pytest

from bench import columns as pages
from fiberbend import columns
from fiberbend.columns import (
    BODY,
    COLUMNS,
    RUN,
    UNIFORM,
    Column,
    check,
    column,
    energy_columns,
    is_column,
    load_columns,
    present_name,
)
from fiberbend.models.choice import MODELS
from fiberbend.models.model import ModelKind
from fiberbend.results.folder import RunFolder


def test_every_group_is_filled_and_every_model_fills_those_that_there_are() -> None:
    groups = {known.group for known in COLUMNS}
    assert groups == set().union(*(model.fills for model in MODELS.values()))
    assert all(RUN in model.fills for model in MODELS.values())


def test_a_model_of_which_nothing_is_known_fills_what_every_run_has() -> None:
    assert ModelKind.fills == {RUN}


def test_every_column_is_said_once_and_in_full() -> None:
    names = [known.name for known in COLUMNS]
    assert len(set(names)) == len(names)
    assert all(known.meaning and not known.meaning.endswith(".") for known in COLUMNS)
    # no row's key is another column's too
    for name in names:
        key = re.sub(r"[{}]", "", name)
        assert [known.name for known in COLUMNS if known.names(key)] == [name]


def test_names_have_one_style() -> None:
    """Lower case and underscores, then the unit as it is written."""
    units = {"°": "deg", "mm²": "mm2", "mm³": "mm3", "N mm": "Nmm", "mm/s": "mm_per_s"}
    for known in COLUMNS:
        name = known.name.replace("min_det_F", "min_det_f")
        unit = units.get(known.unit, known.unit)
        assert name.endswith(f"_{unit}" if unit and name != "chamber_mm3" else unit), name
        stem = name.removesuffix(unit) if unit else name
        assert re.fullmatch(r"[a-z0-9_{}]+", stem), name


def test_energies_have_names_of_their_own() -> None:
    keys = ["ChamberPressure", "Contact[left-post]", "Contact[left_post]", "Elastic[neo-hookean]"]
    assert list(energy_columns(keys).values()) == [
        "energy_chamber_pressure_mJ",
        "energy_contact_left_post_mJ",
        "energy_contact_left_post_2_mJ",
        "energy_elastic_neo_hookean_mJ",
    ]
    assert all(is_column(name) for name in energy_columns(keys).values())
    assert not is_column("energy_left-post_mJ")


def test_loads_have_their_units() -> None:
    assert load_columns("gravity", "", "mJ") == ("load_gravity", "conjugate_gravity_mJ")
    assert load_columns("tip-load", "N", "mm") == ("load_tip_load_N", "conjugate_tip_load_mm")
    assert all(map(is_column, load_columns("tip-load", "N", "mm")))


@pytest.mark.parametrize(
    ("old", "now"),
    [
        ("angle_deg", "angle_deg"),
        ("load pressure", None),
        ("conjugate pressure", None),
        ("load gravity", "load_gravity"),
        ("conjugate gravity", "conjugate_gravity_mJ"),
        ("energy SmearedWinding mJ", "energy_smeared_winding_mJ"),
        ("energy Elastic[yeoh] mJ", "energy_elastic_yeoh_mJ"),
    ],
)
def test_columns_of_older_runs_have_their_present_names(old: str, now: str | None) -> None:
    assert present_name(old) == now
    assert now is None or present_name(now) == now


def test_a_part_in_braces_stands_for_a_name() -> None:
    assert column("contact_roof_area_mm2").unit == "mm²"
    assert column("energy_elastic_yeoh_mJ").name == "energy_{effect}_mJ"


@pytest.mark.parametrize(
    ("key", "model"), [("colour", "body"), ("floor_stretch", "body"), ("min_det_F", "analytic")]
)
def test_what_the_table_does_not_have_is_refused(key: str, model: str) -> None:
    with pytest.raises(KeyError, match=key):
        check([key], MODELS[model])


def test_no_file_has_an_unknown_column(tmp_path: Path) -> None:
    with pytest.raises(KeyError, match="colour"):
        RunFolder(tmp_path).write_history([{"step": 0, "colour": 1.0}])
    assert not (tmp_path / "history.csv").exists()


@pytest.mark.parametrize(("page", "beside"), pages.PAGES.items())
def test_docs_are_written_from_the_table(page: str, beside: bool) -> None:
    text = (pages.ROOT / page).read_text(encoding="utf-8")
    assert pages.written(page, beside) == text, "make docs"


def test_a_made_up_column_works_by_its_line_in_the_table(monkeypatch: pytest.MonkeyPatch) -> None:
    from fiberbend import run
    from tests.run.conftest import small

    made = Column(
        "greatest_v_mm", "mm", "greatest v", UNIFORM, read=lambda _scene, s: float(s.w.max())
    )
    monkeypatch.setattr(columns, "COLUMNS", (*COLUMNS, made))
    column.cache_clear()
    short = {"pressure": {"angle": "20 deg"}}
    case = small(model="section", mesh={}, output={})
    case["effects"][0] = short
    assert all("greatest_v_mm" in row for row in run(case).rows)
    # of a group that the model does not fill, or without a value: no such column
    for other in (
        dataclasses.replace(made, group=BODY),
        dataclasses.replace(made, read=lambda _scene, _state: None),
    ):
        column.cache_clear()
        monkeypatch.setattr(columns, "COLUMNS", (*COLUMNS, other))
        assert "greatest_v_mm" not in run(case).rows[-1]

"""The page of `make accuracy`: its price list and what it takes from a ladder's folder."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from bench import accuracy, prices
from fiberbend.reader.reader import read_case
from fiberbend.schema.units import show
from tests.ladder.parts import of_case, record


@pytest.mark.parametrize("scene", prices.SCENES, ids=lambda scene: scene.effect)
def test_a_scene_differs_from_the_one_beside_it_by_its_effect(scene: prices.Scene) -> None:
    own = prices.rung(scene.effect, scene.settings, "4 mm")
    other = prices.rung(scene.effect, scene.without, "4 mm")
    assert own.digest != other.digest
    # an effect adds unknowns or none, and takes away none
    assert own.unknowns >= other.unknowns > 10_000
    names = [effect.name for effect in own.case.effects]
    assert names[:2] == ["pressure", "winding"]
    assert len(names) - len(other.case.effects) in (0, 1)


def test_the_price_list() -> None:
    found = {"unknowns": 1000, "load_steps": 5, "iterations": 20, "solve_cpu_s": 4.0}
    more = {"unknowns": 1500, "load_steps": 6, "iterations": 30, "solve_cpu_s": 5.0}
    scenes = [{"effect": "gravity", "with": more, "without": found}]
    *_, line = prices.table({"scenes": scenes})
    cells = [cell.strip() for cell in line.strip("|").split("|")]
    assert cells == [
        *("gravity", "1000 → 1500", "5 → 6", "20 → 30", "4.0 → 5.0"),
        *("+500", "+1.0 s (+25 %)"),
    ]


def test_the_least_of_several_times_counts_and_a_failure_is_none() -> None:
    rung = of_case().rungs[1]
    records = [record(rung, {}, wall) for wall in (3.0, 2.0, 4.0)]
    assert prices.least(records)["solve_cpu_s"] == 1.0
    failed = [*records[:2], prices.Record(**{**vars(records[2]), "status": "failed"})]
    with pytest.raises(RuntimeError, match="failed"):
        prices.least(failed)


def test_the_page_begins_with_the_advice(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(accuracy, "RUNS", tmp_path)
    for shown in accuracy.LADDERS:
        folder = tmp_path / f"accuracy_{shown.name}"
        folder.mkdir()
        (folder / "accuracy.json").write_text(json.dumps({"advice": f"Take {shown.name}."}))
    assert accuracy.in_short() == (
        "- **Free bending.** Take free_bending.\n- **Blocked tip.** Take blocked_tip."
    )


def test_scenes_say_the_sizes_of_the_baseline() -> None:
    actuator = read_case(prices.CASE).actuator
    assert actuator.sheath is not None
    effects = {scene.effect for scene in prices.SCENES}
    assert f"sheath of {show(actuator.sheath, 'length')}" in effects
    assert f"caps of {show(actuator.cap, 'length')}, instead of 1 mm" in effects


def test_a_part_of_the_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(accuracy, "RUNS", tmp_path)
    monkeypatch.setattr(accuracy, "IMAGES", tmp_path)
    folder = tmp_path / "accuracy_free_bending"
    (folder / "rungs").mkdir(parents=True)
    (folder / "accuracy.png").write_bytes(b"picture")
    block = "```console\n$ fiberbend run …\n```\n"
    (folder / "accuracy.md").write_text(f"# Free bending\n\nFor 1 % take …\n\n{block}| rung |\n")
    names = [rung.name for rung in of_case().rungs[:2]]
    found = {"advice": "For 1 % take …", "rungs": names}
    (folder / "accuracy.json").write_text(json.dumps(found))
    for rung in of_case().rungs[:2]:
        text = json.dumps(vars(record(rung, {})))
        (folder / "rungs" / f"{rung.name}.json").write_text(text)
    lines = list(accuracy.part(accuracy.LADDERS[0]))
    assert lines[0] == "## Free bending"
    assert "For 1 % take …" in lines
    assert not any(line.startswith("# ") for line in lines)
    assert lines[lines.index("```console") - 1] == "<!-- slow -->"
    assert (tmp_path / "accuracy_free_bending.png").read_bytes() == b"picture"
    other = json.loads(text)
    other["key"]["commit"] = "0" * 40
    (folder / "rungs" / "other.json").write_text(json.dumps(other))
    # what is not in the table has no say
    assert list(accuracy.part(accuracy.LADDERS[0])) == lines
    (folder / "accuracy.json").write_text(json.dumps(found | {"rungs": [*names, "other"]}))
    with pytest.raises(SystemExit, match="expected one"):
        list(accuracy.part(accuracy.LADDERS[0]))

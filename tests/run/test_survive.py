"""The kill loop in short: `make survive` has the long one, of a body and on two ranks too."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench import survive
from bench.survive_kill import loop


@pytest.mark.long
def test_killed_at_random_moments_a_section_comes_to_the_same(tmp_path: Path) -> None:
    found = loop(tmp_path, "section", {1: 3}, seed=1)
    assert sum(len(one.moments) for one in found) == 3
    assert [one.faults for one in found] == [[]] * len(found)


def test_a_table_takes_the_place_of_its_own_only(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = tmp_path / "page.md"
    page.write_text("# Page\n\ntext\n", encoding="utf-8")
    monkeypatch.setattr(survive, "PAGE", page)
    for name, lines in (("a", ["1"]), ("b", ["2"]), ("a", ["3", "4"])):
        survive.put(name, lines)
    a, b = (f"<!-- {name}, by `make survive` -->" for name in "ab")
    parts = f"{a}\n3\n4\n<!-- end of a -->\n\n{b}\n2\n<!-- end of b -->\n"
    assert page.read_text(encoding="utf-8") == f"# Page\n\ntext\n\n{parts}"
    assert survive.kept(page.read_text(encoding="utf-8")) == "\n" + parts.rstrip("\n")

"""The table of mutants is on its page, and its sources and tests are there."""

from __future__ import annotations

import re
from pathlib import Path

from tests.verify.mutants import MISSED, MUTANTS, SAMPLE, mutants_section

ROOT = Path(__file__).resolve().parents[2]


def test_the_page_has_the_table() -> None:
    page = (ROOT / "docs" / "verification.md").read_text(encoding="utf-8")
    assert page.endswith(mutants_section())
    assert MISSED < SAMPLE


def test_what_the_table_names_is_there() -> None:
    for mutant in MUTANTS:
        assert (ROOT / "fem" / mutant.source).exists(), mutant.source
        for name in re.findall(r"test_\w+", mutant.verdict):
            assert (ROOT / "tests" / "fem" / f"{name}.py").exists(), name

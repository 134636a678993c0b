"""Body, cell and section under families of threads: the page of evidence, and bodies again."""

from __future__ import annotations

import re

import pytest

from bench.families import (
    BODY,
    CELL,
    EXAMPLES,
    INTRODUCTION,
    PAGE,
    SMEARED,
    Kind,
    off,
    state,
)

TEXT = PAGE.read_text(encoding="utf-8")
NAMES = ("section, smeared", "cell, discrete", "body, discrete, its middle half")
ALIKE = 0.015
"""Of body and cell, away from the ends."""
MIRRORED = {"angle": 1, "side angle": -1, "twist": -1, "stretch": 1}


def _line(example: str, name: str) -> list[str]:
    """Cells of a line of the page's table of an example."""
    part = TEXT.split(f"## {EXAMPLES[example].title}\n", 1)[1].split("\n## ", 1)[0]
    (line,) = re.findall(rf"^\| {name} \|(.*)\|$", part, re.MULTILINE)
    return [cell.strip() for cell in line.split("|")]


def _known(example: str, name: str) -> dict[str, float]:
    """The state on such a line."""
    return dict(zip(MIRRORED, map(float, _line(example, name)[2:6]), strict=True))


def test_the_page_is_that_of_the_program() -> None:
    assert TEXT.startswith(INTRODUCTION)
    for example in EXAMPLES:
        known, body = (_known(example, name) for name in NAMES[1:])
        assert max(map(abs, off(body, known).values())) < ALIKE


@pytest.mark.parametrize("kind", [SMEARED, CELL], ids="-".join)
@pytest.mark.parametrize("example", EXAMPLES)
def test_mirrored_hands_give_mirrored_answers_those_of_the_page(example: str, kind: Kind) -> None:
    found = state(EXAMPLES[example].solved(kind))
    image = state(EXAMPLES[example].solved(kind, mirrored=True))
    shown = _known(example, NAMES[[SMEARED, CELL].index(kind)])
    for name, sign in MIRRORED.items():
        assert image[name] == pytest.approx(sign * found[name], rel=1e-10, abs=1e-10)
        assert found[name] == pytest.approx(shown[name], abs=2e-5 if name == "stretch" else 2e-3)


@pytest.mark.hard
@pytest.mark.parametrize("example", EXAMPLES)
def test_the_middle_of_a_body_is_its_cell(example: str) -> None:
    cell, body = (state(EXAMPLES[example].solved(kind)) for kind in (CELL, BODY))
    assert max(map(abs, off(body, cell).values())) < ALIKE, (body, cell)


@pytest.mark.hard
@pytest.mark.parametrize("example", ["twist", "aside"])
def test_a_body_of_mirrored_hands_is_the_mirror_image(example: str) -> None:
    found = state(EXAMPLES[example].solved(BODY))
    image = state(EXAMPLES[example].solved(BODY, mirrored=True))
    for name, sign in MIRRORED.items():
        assert image[name] == pytest.approx(sign * found[name], rel=1e-10, abs=1e-8), name


@pytest.mark.parametrize("example", ["twist", "braid"])
def test_closer_threads_come_to_the_section(example: str) -> None:
    what = "twist" if example == "twist" else "stretch"
    apart = []
    for finer in (1, 2):
        kinds = (CELL, SMEARED)
        cell, section = (state(EXAMPLES[example].solved(k, finer=finer)) for k in kinds)
        apart.append(abs(off(cell, section)[what]))
    assert apart[1] < 0.4 * apart[0] < 0.006

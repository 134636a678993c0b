"""Exact solutions on several meshes: rates, reference numbers, and docs/verification.md."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.verify import helix
from tests.verify.ladder import Ladder, Rung, rates
from tests.verify.mutants import mutants_section
from tests.verify.problems import LADDERS
from tests.verify.report import HEAD, helix_section, ladder_section, limits_section

PAGE = Path(__file__).resolve().parents[2] / "docs" / "verification.md"
CELLS = ("hexahedron", "tetrahedron")
pytestmark = pytest.mark.verify


class Book:
    """Collects what the tests find; complete, it becomes the page."""

    def __init__(self) -> None:
        self.climbed: dict[str, dict[str, list[Rung]]] = {}
        self.helix = ""

    @property
    def complete(self) -> bool:
        """Whether every problem was solved with every element."""
        ladders = all(set(self.climbed.get(x.title, {})) == set(CELLS) for x in LADDERS)
        return ladders and bool(self.helix)

    def write(self) -> None:
        """Write the page."""
        sections = [ladder_section(x, self.climbed[x.title]) for x in LADDERS]
        PAGE.parent.mkdir(exist_ok=True)
        PAGE.write_text(
            "\n".join([HEAD, *sections, self.helix, limits_section(), mutants_section()]),
            encoding="utf-8",
        )


@pytest.fixture(scope="module")
def book() -> Iterator[Book]:
    """Written when all of it is there, so that a part of the ladder never spoils the page."""
    pages = Book()
    yield pages
    if pages.complete:
        pages.write()


@pytest.mark.parametrize("cell", CELLS)
@pytest.mark.parametrize("ladder", LADDERS, ids=lambda ladder: ladder.__name__)
def test_ladder(ladder: type[Ladder], cell: str, book: Book) -> None:
    # an inconsistent form, a wrong sign of p or a geometry of lower order spoils a rate
    rungs = ladder().climb(cell)
    h = [1 / rung.n for rung in rungs]
    assert rates([rung.u for rung in rungs], h)[-1] > 2.7
    assert rates([rung.p for rung in rungs], h)[-1] > 1.7
    for name, (exact, tolerance) in ladder.reference.items():
        assert rungs[-1].values[name] == pytest.approx(exact, rel=tolerance), name
    book.climbed.setdefault(ladder.title, {})[cell] = rungs


def test_double_helix_tends_to_hoops(book: Book) -> None:
    # the key test of the fibers: real curves, a real ribbon, no smearing anywhere
    pitches = [helix.solve(k) for k in helix.FINENESS]
    errors = [x.error for x in pitches]
    sizes = [x.pitch for x in pitches]
    orders = rates(errors, sizes)
    assert all(0.9 < order < 1.3 for order in orders), orders
    # a straight line through the last two pitches meets the exact pressure at zero; what is left
    # is the second order, a tenth of the last error
    last = slice(-2, None)
    (e0, e1), (p0, p1) = errors[last], sizes[last]
    limit = e1 - (e0 - e1) / (p0 - p1) * p1
    assert abs(limit) < 0.1 * errors[-1]
    book.helix = helix_section(pitches, limit)

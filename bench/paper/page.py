"""The page of all parts: one HTML file that needs nothing else, and docs/paper.md."""

from __future__ import annotations

import dataclasses
import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.paper.facts import STATED
from bench.paper.lines import WIDTH
from bench.paper.part import Figure, Found, Part, Table
from bench.paper.verdict import Verdict
from fiberbend.drawing.page import save
from fiberbend.drawing.style import Style
from fiberbend.report.page import asset, citation, data_address, inside
from fiberbend.version import __version__

if TYPE_CHECKING:
    from markupsafe import Markup

PIXELS = round(100 * WIDTH)
"""Width of a figure on the page at 100 %."""
_SHARP = 200.0
WORDS = (
    "Every figure and table of the paper that a model can answer, drawn by this program. What the "
    "paper prints as a number, a range or a sign is in the tables with a verdict; a curve or a "
    "point of its figures without a number is not. A verdict is computed from our number and a "
    "bound. The bound is the paper's own where it states one, and the table says so where it is "
    "chosen here.",
    "Measured points are not published. Where the paper's number is an error against them, a "
    "verdict says what can be known without: whether any measurement could be within the stated "
    "errors of two models at once.",
    "The paper does not state the pitch of the winding, the floor of its simulations, L_f, and "
    "whether L includes the caps. Assumed here: pitch 3 mm, floor 2 mm, L_f = the cap of 15 mm, L "
    "without the caps.",
)


@dataclasses.dataclass(frozen=True)
class Made:
    """A part that has been made.

    Attributes:
        part: the part.
        found: what it has to show.
    """

    part: Part
    found: Found

    @property
    def name(self) -> str:
        """Of its anchor."""
        return self.part.name

    @property
    def title(self) -> str:
        """Its heading."""
        return self.part.title

    @property
    def commands(self) -> list[str]:
        """That make it again."""
        return [*self.found.commands, f"python -m bench.paper --only {self.name}"]


def missing(made: Sequence[Made]) -> list[str]:
    """Keys of stated numbers that no part has a verdict on."""
    judged = {verdict.stated.key for each in made for verdict in each.found.verdicts}
    return [key for key in STATED if key not in judged]


def counts(made: Sequence[Made]) -> dict[str, int]:
    """How many verdicts there are of each kind."""
    words = Counter(verdict.word for each in made for verdict in each.found.verdicts)
    return {word: words[word] for word in ("kept", "not kept", "cannot be compared")}


def sentence(made: Sequence[Made]) -> str:
    """How many verdicts there are of each kind, in words."""
    found = counts(made)
    taken = sum(verdict.taken for each in made for verdict in each.found.verdicts)
    return (
        f"{found['kept']} kept, of which {taken} are inputs that are taken as stated; "
        f"{found['not kept']} not kept; {found['cannot be compared']} cannot be compared."
    )


def draw(made: Sequence[Made], folder: Path) -> None:
    """Write every figure as PNG, twice as fine as it is shown, and as PDF."""
    folder.mkdir(parents=True, exist_ok=True)
    for each in made:
        for figure in each.found.figures:
            save(figure.page, folder / f"{figure.name}.png", Style(dpi=_SHARP))
            save(figure.page, folder / f"{figure.name}.pdf", Style("pdf", dpi=_SHARP))


def html(made: Sequence[Made], folder: Path, form: str) -> str:
    """The page, figures and files inside.

    Args:
        made: its parts.
        folder: has their figures.
        form: what was solved, in words.
    """
    parts = [
        {
            "name": each.name,
            "title": each.title,
            "commands": each.commands,
            "counts": counts([each]),
            "found": dataclasses.replace(each.found, figures=[]),
        }
        for each in made
    ]
    for shown, each in zip(parts, made, strict=True):
        pictures = [_picture(figure, folder) for figure in each.found.figures]
        shown["found"] = {
            field.name: getattr(each.found, field.name) for field in dataclasses.fields(each.found)
        } | {"figures": pictures}
    files = [folder / f"{f.name}.pdf" for each in made for f in each.found.figures]
    text: str = (
        _environment()
        .get_template("paper.html")
        .render(
            title="Polygerinos et al. 2015, computed again",
            form=form,
            words=WORDS,
            parts=parts,
            counts=counts(made),
            sentence=sentence(made),
            downloads=[inside(file, folder) for file in files],
            cite=citation(),
            version=__version__,
        )
    )
    return text


def _picture(figure: Figure, folder: Path) -> dict[str, Any]:
    name = f"{figure.name}.png"
    address = data_address((folder / name).read_bytes(), name)
    return {"address": address, "caption": figure.caption, "width": PIXELS}


def _environment() -> Any:
    import jinja2

    here = jinja2.FileSystemLoader(Path(__file__).parent)
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader([here, jinja2.PackageLoader("fiberbend.report", "templates")]),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals["asset"] = asset
    environment.filters["code"] = _code
    return environment


def _code(text: str) -> Markup:
    """Text of a part as HTML, `commands` as such."""
    from markupsafe import Markup, escape

    return Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", str(escape(text))))


def markdown(made: Sequence[Made], form: str) -> str:
    """docs/paper.md.

    Args:
        made: its parts.
        form: what was solved, in words.
    """
    lines = [
        "# The paper, figure by figure",
        "",
        "<!-- Written by `make paper FULL=1`; do not edit by hand. -->",
        "",
        f"`make paper` draws this page again as runs/paper/index.html; this one is the {form}.",
        f"**Verdicts: {sentence(made)}**",
        "",
    ]
    for text in WORDS:
        lines += [text, ""]
    for each in made:
        lines += [f"## {each.title}", ""]
        for text in each.found.words:
            lines += [text, ""]
        for figure in each.found.figures:
            lines += [f"![{figure.caption}](images/paper_{figure.name}.png)", ""]
            lines += [f"*{figure.caption}*", ""]
        for table in each.found.tables:
            lines += [f"{table.caption}:", "", *_table(table), ""]
        if each.found.verdicts:
            lines += [*_table(_verdicts(each.found.verdicts)), ""]
        lines += [
            f"**Erratum, {e.place}.** Printed: {e.printed}. Right: {e.right}.\n"
            for e in each.found.errata
        ]
        lines += ["Made by " + "; ".join(f"`{command}`" for command in each.commands) + ".", ""]
    return "\n".join(lines).rstrip() + "\n"


def _verdicts(verdicts: Sequence[Verdict]) -> Table:
    head = ("stated", "printed", "our model", "gives", "verdict", "because")
    rows = [
        (
            f"{v.stated.what} ({v.stated.place})",
            v.stated.printed,
            v.model,
            v.ours,
            f"**{v.word}**",
            v.why,
        )
        for v in verdicts
    ]
    return Table("", head, rows)


def _table(table: Table) -> list[str]:
    rows = [[cell.replace("|", r"\|") for cell in row] for row in table.rows]
    return [
        "| " + " | ".join(table.head) + " |",
        "|" + "---|" * len(table.head),
        *("| " + " | ".join(row) + " |" for row in rows),
    ]

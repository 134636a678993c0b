"""Every command, script and file in README and docs does what the page says."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from bench.doc_check import Checker, targets
from bench.doc_commands import ROOT, Reader, blocks, pages

PAGES = {str(page.relative_to(ROOT)): page for page in pages()}
RECIPES = "CONTRIBUTING.md"
"""Its blocks are recipes that tests/contributing applies."""
QUICK = ("README.md", "docs/when_it_fails.md")
"""The pages that `make test` follows; `make test-long` follows the others."""
WITH_BLOCKS = [
    pytest.param(name, marks=() if name in QUICK else pytest.mark.long)
    for name, page in PAGES.items()
    if name != RECIPES and "```" in page.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("name", WITH_BLOCKS)
def test_a_reader_can_do_what_the_page_says(name: str, tmp_path: Path) -> None:
    Reader(tmp_path).follow(PAGES[name])


def test_every_block_says_its_language() -> None:
    """Also on pages that only `make test-long` follows: `blocks` refuses a block that does not."""
    found = {name: sum(1 for _ in blocks(page)) for name, page in PAGES.items()}
    followed = {each.values[0] for each in WITH_BLOCKS}
    assert {name for name, count in found.items() if count} == {*followed, RECIPES}


@pytest.mark.parametrize("name", PAGES)
def test_commands_within_sentences_exist(name: str) -> None:
    text = PAGES[name].read_text(encoding="utf-8")
    for words in re.findall(r"`make((?: [^`]+)?)`", text):
        for word in shlex.split(words):
            if not word.startswith("-") and "=" not in word:
                assert word in targets(), f"{name}: make {word}"
    for path in re.findall(r"`(?:\S+=\S+ )*python ((?:bench|examples)/[^`\s]+)[^`]*`", text):
        assert (ROOT / path).is_file(), f"{name}: {path}"
    from fiberbend.cli import app

    commands = [word for word in app if not word.startswith("-")]
    for word in re.findall(r"`fiberbend ([a-z]+)", text):
        assert word in commands, f"{name}: fiberbend {word}"


@pytest.mark.parametrize("name", PAGES)
def test_links_to_files_lead_somewhere(name: str) -> None:
    page = PAGES[name]
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert "[](" not in text, "a link without words is not seen where the page is not built"
    for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", text):
        if not re.match(r"\w+:", target):
            assert (page.parent / target).exists(), f"{name}: {target}"


def test_reasons_and_warnings_on_the_page_are_those_of_the_code() -> None:
    text = (ROOT / "docs" / "when_it_fails.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `([^`]+)` \|", text[text.index("## No solution") :], re.MULTILINE)
    sources = [
        path.read_text(encoding="utf-8")
        for folder in ("fem", "fiberbend")
        for path in (ROOT / folder).rglob("*.py")
    ]
    assert len(rows) >= 15
    for row in rows:
        assert any(row in source for source in sources), row


def test_the_readme_is_short() -> None:
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 150


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("fiberbend rum cases/section.yaml", "rum"),
        ("fiberbend run cases/section.yaml --outt runs/x", "outt"),
        ("fiberbend run cases/sektion.yaml", "sektion"),
        ('fiberbend run cases/section.yaml --set actuator.wal="3 mm"', "wal"),
        ("fiberbend sweep cases/section.yaml", "section.yaml"),
        ("make demmo", "demmo"),
        ("make sweep SWEEP=cases/sweeps/none.yaml", "none.yaml"),
        ("python bench/none.py", "none.py"),
        ("mpirun 2 fiberbend run cases/section.yaml", "mpirun"),
        ("rm -rf runs", "nobody knows"),
    ],
)
def test_a_slow_command_that_would_not_start_is_found(
    line: str, reason: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=reason):
        Checker(Reader(tmp_path).folder).command(line, "page:1")


@pytest.mark.parametrize("line", ["fiberbend validate cases/none.yaml", "false"])
def test_a_command_that_fails_is_found(line: str, tmp_path: Path) -> None:
    page = ROOT / "docs" / "made_up.md"
    text = f"```console\n$ {line}\noutput\n```\n"
    page = tmp_path / "page.md"
    page.write_text(text, encoding="utf-8")
    (block,) = blocks(page)
    with pytest.raises(AssertionError, match="exit code 1"):
        Reader(tmp_path / "reader").run(block.commands()[0], block.code)


def test_a_message_that_is_not_printed_is_found(tmp_path: Path) -> None:
    page = ROOT / "docs" / "when_it_fails.md"
    made = tmp_path / "page.md"
    wrong = page.read_text(encoding="utf-8").replace("actuator.wall: 3, expected", "wall: 3, wants")
    made.write_text(wrong[: wrong.index("A key does not exist")], encoding="utf-8")
    with pytest.raises(AssertionError, match="wall: 3, wants"):
        Reader(tmp_path / "reader").follow(made)


@pytest.mark.parametrize("text", ["    fiberbend run\n", "```\nfiberbend run\n```\n"])
def test_a_block_without_a_language_is_refused(text: str, tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(f"text\n\n{text}", encoding="utf-8")
    with pytest.raises(ValueError, match="language"):
        list(blocks(page))


def test_marks_are_read(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "<!-- slow -->\n```bash\n# comment\nmake \\\n  demo\n```\n\n"
        "<!-- fails 1 -->\n```console\n$ false\nno\n```\n\n"
        "<!-- slow -->\n\ntext between\n\n```python\nimport os\n```\n\n"
        "<!-- file: a.csv -->\n```csv\na,b\n```\n",
        encoding="utf-8",
    )
    slow, failing, script, file = blocks(page)
    assert (slow.slow, slow.commands()) == (True, ["make    demo"])
    assert (failing.code, failing.commands()) == (1, ["false"])
    assert not script.slow
    assert (file.file, file.text) == ("a.csv", "a,b\n")
    assert (slow.prints, failing.prints) == (False, True)

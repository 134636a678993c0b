"""What README and docs ask a reader to do, taken from the pages and done.

A fenced block `console` or `bash` has commands, `python` a script, `yaml` a case or a part of one.
A comment on the line above a block says more of it:

    <!-- slow -->            not run: its command lines are checked word by word
    <!-- fails 1 -->         its commands end with this exit code, and print what the block shows
    <!-- prints -->          its commands print what the block shows
    <!-- file: trial.csv --> its text is that of a file in the reader's folder
    <!-- from: PATH -->      the picture below is the one that the commands leave there
"""

from __future__ import annotations

import dataclasses
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token

ROOT = Path(__file__).resolve().parent.parent
SHELLS = ("console", "bash")
TEXTS = ("text", "csv", "json", "c", "diff", "{toctree}", "{eval-rst}")
"""Blocks that are not run: what a program printed, data, and languages with tests elsewhere."""
SECONDS = 180
_MARK = re.compile(r"<!--\s*(slow|prints|fails (\d+)|file: (\S+)|from: (\S+))\s*-->")


@dataclasses.dataclass(frozen=True)
class Block:
    """A fenced block with what its comment says.

    Attributes:
        language: the word after the fence.
        text: what is inside.
        line: of the page.
        slow: it is not run.
        code: exit code of its commands.
        file: file whose text it is, or "".
        prints: what it shows beside the commands is what they print.
    """

    language: str
    text: str
    line: int
    slow: bool = False
    code: int = 0
    file: str = ""
    prints: bool = False

    def shown(self) -> list[str]:
        """What a console shows beside the commands, in pieces where `…` leaves something out."""
        lines = [line for line in self.text.splitlines() if not line.startswith("$ ")]
        return [" ".join(piece.split()) for piece in " ".join(lines).split("…") if piece.strip()]

    def commands(self) -> list[str]:
        """Its command lines, those that go on after a backslash as one; no comments, no output."""
        lines = self.text.replace("\\\n", " ").splitlines()
        if self.language == "console":
            lines = [line[2:] for line in lines if line.startswith("$ ")]
        return [line.strip() for line in lines if line.strip() and not line.startswith("#")]


@dataclasses.dataclass(frozen=True)
class Picture:
    """A picture that the commands of a page make.

    Attributes:
        source: where they leave it.
        target: where the page shows it from.
    """

    source: str
    target: Path


def pages() -> list[Path]:
    """README, CONTRIBUTING and every page of docs/."""
    docs = (ROOT / "docs").rglob("*.md")
    written = [page for page in sorted(docs) if not {"_build", "_generated"} & set(page.parts)]
    return [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *written]


def _tokens(page: Path) -> list[Token]:
    return MarkdownIt("commonmark").enable("table").parse(page.read_text(encoding="utf-8"))


def blocks(page: Path) -> Iterator[Block]:
    """The code blocks of a page, in their order.

    Raises:
        ValueError: a block that does not say its language, with its line.
    """
    marks: list[re.Match[str]] = []
    for token in _tokens(page):
        line = (token.map or (0, 0))[0] + 1
        if token.type == "html_block":
            marks = list(_MARK.finditer(token.content))
        elif token.type in ("fence", "code_block"):
            language = token.info.strip()
            if not language or token.type == "code_block":
                raise ValueError(f"{page}:{line}: a block of code that does not say its language")
            found: dict[str, object] = {}
            for mark in marks:
                word, code, file, _ = mark.groups()
                if code:
                    found["code"], found["prints"] = int(code), True
                elif file:
                    found["file"] = file
                else:
                    found[word] = True
            yield Block(language, token.content, line, **found)  # type: ignore[arg-type]
            marks = []
        elif token.type != "paragraph_open":
            marks = []


def pictures(page: Path) -> Iterator[Picture]:
    """The pictures of a page that its own commands make."""
    source = ""
    for token in _tokens(page):
        if token.type == "html_block":
            mark = re.search(r"<!--\s*from: (\S+)\s*-->", token.content)
            source = mark.group(1) if mark else ""
        for child in token.children or ():
            if child.type == "image" and source:
                yield Picture(source, (page.parent / str(child.attrs["src"])).resolve())
                source = ""


def environment(folder: Path) -> dict[str, str]:
    """The variables of a reader's terminal: `fiberbend` and `python` are this program's.

    Args:
        folder: where the two commands may be put.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name, arguments in (("fiberbend", " -m fiberbend"), ("python", "")):
        command = folder / name
        command.write_text(
            f'#!/bin/sh\nexec "{sys.executable}"{arguments} "$@"\n', encoding="utf-8"
        )
        command.chmod(0o755)
    return os.environ | {
        "PATH": f"{folder}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
        "OPENBLAS_NUM_THREADS": "1",
    }


class Reader:
    """Someone who does what a page says, in a folder that has cases and examples.

    Args:
        folder: an empty folder.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder / "fiberbend"
        self.folder.mkdir(parents=True)
        for name in ("cases", "examples"):
            shutil.copytree(ROOT / name, self.folder / name)
        shutil.copy(ROOT / "Makefile", self.folder)
        self.environment = environment(folder / "bin")

    def run(self, command: list[str] | str, code: int) -> str:
        """Run a command line, or a program with its arguments; what it printed.

        Args:
            command: for a shell where it is text.
            code: the exit code that it must have.

        Raises:
            AssertionError: another exit code; with everything that was printed.
        """
        done = subprocess.run(
            ["bash", "-c", command] if isinstance(command, str) else command,
            cwd=self.folder,
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=SECONDS,
            check=False,
        )
        printed = done.stdout + done.stderr
        assert done.returncode == code, f"{command}\nexit code {done.returncode}\n{printed}"
        return printed

    def follow(self, page: Path) -> None:
        """Do what a page says, its Python last.

        Raises:
            AssertionError: something that does not work as the page says.
            ValueError: a command that is not run and that nothing here can check.
        """
        from bench.doc_check import Checker

        check = Checker(self.folder)
        scripts = []
        for block in blocks(page):
            where = f"{page.name}:{block.line}"
            if block.file:
                path = self.folder / block.file
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(block.text, encoding="utf-8")
            elif block.language in SHELLS:
                printed = ""
                for command in block.commands():
                    if block.slow:
                        check.command(command, where)
                    else:
                        printed += self.run(command, block.code)
                words = " ".join(printed.split())
                for piece in block.shown() if block.prints else ():
                    assert piece in words, f"{where}: {piece!r} is not printed, but {printed}"
            elif block.language == "python":
                check.script(block.text, where)
                if not block.slow:
                    scripts.append(block.text)
            elif block.language == "yaml":
                check.yaml(block.text, where)
            elif block.language not in TEXTS:
                raise ValueError(f"{where}: nobody runs a block of {block.language}")
        if scripts:
            self.run([sys.executable, "-c", "\n".join(scripts)], 0)
        for picture in pictures(page):
            assert (self.folder / picture.source).is_file(), f"{page}: {picture.source} not made"

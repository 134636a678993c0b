"""Command lines and files of the documentation that are too slow to run, checked word by word."""

from __future__ import annotations

import ast
import importlib
import importlib.util
import itertools
import re
import shlex
import subprocess
from pathlib import Path
from typing import Any

import yaml

ROOT = Path(__file__).resolve().parent.parent


def targets() -> set[str]:
    """What `make` can be asked for."""
    text = (ROOT / "Makefile").read_text(encoding="utf-8")
    return set(re.findall(r"^([a-z0-9-]+):", text, flags=re.MULTILINE))


class Checker:
    """Checks that a command would start, without starting it.

    Args:
        folder: the reader's folder.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.promised: set[str] = set()
        """Folders that commands which were not run would have left."""

    def command(self, line: str, where: str) -> None:
        """Check a command line.

        Args:
            line: as a reader types it.
            where: page and line, for messages.

        Raises:
            ValueError: what is wrong, or a program of which nothing is known here.
        """
        words = shlex.split(line, comments=True)
        while words and re.fullmatch(r"[A-Z_]+=\S*", words[0]):
            words.pop(0)
        if words[0] == "mpirun":
            if words[1] != "-n" or not words[2].isdigit():
                raise ValueError(f"{where}: {line}: expected mpirun -n NUMBER COMMAND")
            words = words[3:]
        # of any environment
        program, rest = re.sub(r"^\S+/bin/", "", words[0]), words[1:]
        known = {
            "fiberbend": self._fiberbend,
            "make": self._make,
            "python": self._python,
            "python3": self._python,
            "pip": self._pip,
            "source": self._source,
            "sbatch": self._sbatch,
            "docker": self._docker,
            "conda": self._conda,
            "cd": lambda _: None,
            "git": lambda _: None,
            "./setup.sh": lambda _: None,
        }
        if program not in known:
            raise ValueError(f"{where}: {line}: nobody knows how to check {program}")
        try:
            known[program](rest)
        except Exception as error:
            raise ValueError(f"{where}: {line}: {error}") from error

    def _make(self, words: list[str]) -> None:
        for word in words:
            name, _, value = word.partition("=")
            if value:
                if value.endswith(".yaml") and not (self.folder / value).is_file():
                    raise ValueError(f"no file {value}")
            elif not word.startswith("-") and name not in targets():
                raise ValueError(f"make has no target {name}")

    def _python(self, words: list[str]) -> None:
        if words[0] == "-m":
            if importlib.util.find_spec(words[1]) is None:
                raise ValueError(f"no module {words[1]}")
        else:
            ast.parse((ROOT / words[0]).read_text(encoding="utf-8"))

    def _pip(self, words: list[str]) -> None:
        for option, name in itertools.pairwise(words):
            if option == "--constraint" and not (ROOT / name).is_file():
                raise ValueError(f"no file {name}")

    def _sbatch(self, words: list[str]) -> None:
        script, *given = (word for word in words if not word.startswith("--"))
        for name in (script, *given):
            if not (self.folder / name).is_file():
                raise ValueError(f"no file {name}")
        done = subprocess.run(
            ["bash", "-n", script], cwd=self.folder, capture_output=True, text=True, check=False
        )
        if done.returncode:
            raise ValueError(done.stderr)

    def _docker(self, words: list[str]) -> None:
        if words == ["build", "--tag", "fiberbend", "."]:
            return
        if words[0] != "run":
            raise ValueError("expected docker build --tag fiberbend . or docker run")
        at = words.index("fiberbend")
        options, rest = words[1:at], words[at + 1 :]
        known = {"--rm": 1, "--volume": 2, "--network=none": 1, "--entrypoint": 2}
        entry = "fiberbend"
        while options:
            if options[0] not in known:
                raise ValueError(f"docker run {options[0]}, expected one of {', '.join(known)}")
            if options[0] == "--entrypoint":
                entry = options[1]
            options = options[known[options[0]] :]
        self.command(shlex.join([entry, *rest]), "in the container")

    def _conda(self, words: list[str]) -> None:
        if words[0] != "activate" and words[:3] != ["env", "create", "--file"]:
            raise ValueError("expected conda env create --file FILE or conda activate NAME")
        if words[0] == "env" and not (ROOT / words[3]).is_file():
            raise ValueError(f"no file {words[3]}")

    def _source(self, words: list[str]) -> None:
        if words != [".venv/bin/activate"]:
            raise ValueError("expected .venv/bin/activate")

    def _fiberbend(self, words: list[str]) -> None:
        from fiberbend.cli import app
        from fiberbend.design.reading import read_design
        from fiberbend.hand.reading import read_hand
        from fiberbend.reader.reader import read_case
        from fiberbend.sweep.points import read_sweep

        _, bound, *_ = app.parse_args(words, exit_on_error=False, print_error=False)
        name, given = words[0], bound.arguments
        for path in (word for word in words[1:] if word.startswith("runs/")):
            there = (self.folder / path).exists() or path in self.promised
            if not there and words[words.index(path) - 1] != "--out":
                raise ValueError(f"no earlier command makes {path}")
        files = [self.folder / word for word in words[1:2] if word.endswith(".yaml")]
        changes = given.get("settings", ())
        for file in files:
            if name == "sweep":
                read_sweep(file, changes)
            elif name == "design":
                read_design(file, changes)
            elif name == "hand":
                read_hand(file, changes)
            elif name != "init":
                read_case(file, changes)
            default = f"runs/{file.stem}" + ("_control" if name == "control" else "")
            self.promised.add(str(given.get("out") or default))

    def script(self, text: str, where: str) -> None:
        """Check a Python script: it compiles, and what it imports is there.

        Raises:
            ValueError: a name that cannot be imported.
            SyntaxError: it does not compile.
        """
        for node in ast.walk(ast.parse(text, where)):
            if isinstance(node, ast.ImportFrom) and node.module:
                module = importlib.import_module(node.module)
                for alias in node.names:
                    if not hasattr(module, alias.name):
                        raise ValueError(f"{where}: {node.module} has no {alias.name}")
            elif isinstance(node, ast.Import):
                for alias in node.names:
                    importlib.import_module(alias.name)

    def _part_of_design(self, data: dict[str, Any]) -> None:
        """Check keys of a design by those that a whole one has."""
        from fiberbend.design.file import DesignFile

        whole = {"case": "case.yaml", "vary": {}, **data}
        DesignFile.model_validate(whole)

    def yaml(self, text: str, where: str) -> None:
        """Check a whole case, sweep, design or hand, or keys of a case, sweep or design.

        Raises:
            ValueError: keys that neither has.
            fiberbend.schema.problems.CaseError: what is wrong with the case.
        """
        from fiberbend.case.case import Case
        from fiberbend.design.file import DesignFile
        from fiberbend.hand.file import HandFile
        from fiberbend.reader.base_case import HAND
        from fiberbend.reader.reader import parse_case
        from fiberbend.sweep.file import SweepFile

        data: Any = yaml.safe_load(text)
        if data is None:
            return
        if isinstance(data, dict) and {"actuator", "materials", "effects"} <= set(data):
            parse_case(data)
        elif isinstance(data, dict) and HAND in data:
            HandFile.model_validate(data)
        elif isinstance(data, dict) and {"case", "targets"} <= set(data):
            DesignFile.model_validate(data)
        elif isinstance(data, dict) and {"targets", "goals", "confirm", "search"} & set(data):
            self._part_of_design(data)
        elif isinstance(data, dict) and {"vary", "zip", "points"} & set(data):
            SweepFile.model_validate(data)
        else:
            unknown = set(data) - set(Case.model_fields) - set(SweepFile.model_fields)
            if unknown:
                raise ValueError(f"{where}: no case and no sweep has the keys {sorted(unknown)}")

"""The command's help, version and completion: what a newcomer sees first."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from fiberbend import __version__
from fiberbend.cli import app, main
from fiberbend.reader.reader import read_case
from fiberbend.sweep.points import read_sweep

ROOT = Path(__file__).resolve().parents[2]
PYTHON = Path(sys.executable)


@pytest.mark.parametrize("arguments", [["version"], ["--version"]])
def test_version(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 0
    assert capsys.readouterr().out.strip() == __version__


def test_a_file_that_cannot_be_written_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = tmp_path / "run"
    case = str(ROOT / "cases" / "section.yaml")
    quick = ["--set", "model=analytic", "--set", "output={pictures: false, report: false}"]
    assert main(["run", case, "--out", str(run), "--quiet", *quick]) == 0
    capsys.readouterr()
    (tmp_path / "file").write_text("")
    for target in (tmp_path, tmp_path / "file" / "page.html"):
        assert main(["report", str(run), "--out", str(target)]) == 1
        said = capsys.readouterr().err
        assert said.startswith(f"{target}: ")
        assert said.count("\n") == 1


@pytest.mark.skipif(os.geteuid() != 0, reason="only root becomes somebody else")
def test_pictures_of_a_folder_that_is_read_only(tmp_path: Path) -> None:
    """One line on the file, and none of matplotlib on its settings, where HOME is not writable."""
    # a virtual environment's Python is a link to one that may lie in a home
    needed = (ROOT, PYTHON, PYTHON.resolve())
    if not all(place.stat().st_mode & 0o001 for each in needed for place in each.parents):
        pytest.skip("nobody else can read the program")
    cache = tmp_path / "cache"
    cache.mkdir(mode=0o700)
    os.chown(cache, 65534, 65534)
    case = tmp_path / "case.yaml"
    case.write_text((ROOT / "cases" / "section.yaml").read_text())
    for place in (tmp_path, *tmp_path.parents[:-1]):
        if place.is_relative_to("/tmp") and place != Path("/tmp"):
            place.chmod(0o755)
    command = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"]
    environment = os.environ | {"HOME": str(tmp_path / "none"), "PYTHONPATH": str(ROOT)}
    environment |= {"PYTHONDONTWRITEBYTECODE": "1", "XDG_CACHE_HOME": str(cache)}
    environment.pop("MPLCONFIGDIR", None)
    code = "import sys; from fiberbend.cli import main; sys.exit(main(sys.argv[1:]))"
    done = subprocess.run(
        [*command, sys.executable, "-c", code, "show", str(case)],
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
    )
    target = tmp_path / "case_at_rest.png"
    assert (done.returncode, done.stderr) == (1, f"{target}: Permission denied, expected a file\n")


COMMANDS = ("validate", "plan", "run", "sweep", "control", "mesh", "completion")


@pytest.mark.parametrize("flag", ["--help", "-h"])
def test_help_lists_the_commands(flag: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([flag]) == 0
    out = capsys.readouterr().out
    for command in (*COMMANDS, "schema", "version"):
        assert f" {command} " in out


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_a_command_has_examples_that_can_be_read(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([command, "--help"]) == 0
    _, _, examples = capsys.readouterr().out.partition("Examples:")
    lines = [line for line in examples.splitlines() if f"fiberbend {command}" in line]
    assert len(lines) >= 2
    for line in lines:
        _, _, text = line.partition("fiberbend ")
        words = shlex.split(text.partition(" >")[0].removesuffix(")"))
        _, bound, _ = app.parse_args(words, exit_on_error=False, print_error=False)
        if command != "completion":
            path = ROOT / str(bound.args[0])
            settings = bound.kwargs.get("settings", ())
            read = read_sweep if command == "sweep" else read_case
            read(path, settings)  # type: ignore[operator]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_names_commands_and_options(
    shell: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["completion", shell]) == 0
    script = capsys.readouterr().out
    for word in ("validate", "overwrite", "dead-zone-divisor"):
        assert word in script
    if shell == "bash":
        done = subprocess.run(["bash", "-n"], input=script, text=True, capture_output=True)
        assert (done.returncode, done.stderr) == (0, "")


COMPLETE = """
source /dev/stdin <<< "$SCRIPT"
COMP_WORDS=($WORDS "$LAST"); COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
_fiberbend; printf '%s\\n' "${COMPREPLY[@]}"
"""


@pytest.mark.parametrize(
    ("words", "last", "expected"),
    [
        ("fiberbend", "va", "validate"),
        ("fiberbend run", "--ov", "--overwrite"),
        ("fiberbend control --plant", "s", "section"),
        ("fiberbend run", "cases/section.ya", "cases/section.yaml"),
        ("fiberbend sweep", "cases/sweeps/radius_len", "cases/sweeps/radius_length_wall.yaml"),
    ],
)
def test_bash_completes(
    words: str, last: str, expected: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["completion", "bash"]) == 0
    environment = os.environ | {
        "SCRIPT": capsys.readouterr().out, "WORDS": words, "LAST": last
    }  # fmt: skip
    done = subprocess.run(
        ["bash", "-c", COMPLETE], env=environment, cwd=ROOT, capture_output=True, text=True
    )
    assert (done.stdout.split(), done.stderr) == ([expected], "")

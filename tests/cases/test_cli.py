"""The command: exit codes, one line per problem, one voice under mpirun."""

from __future__ import annotations

import json
import subprocess
import sys
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from fiberbend.cli import main
from fiberbend.reader.reader import read_case
from fiberbend.results.folder import RunFolder
from fiberbend.running import launch
from tests.cases import bad_cases

ROOT = Path(__file__).resolve().parents[2]
BASELINE = str(ROOT / "cases" / "free_bending.yaml")
SWEEP = str(ROOT / "cases" / "sweeps" / "radius_length_wall.yaml")
TERSE = ["actuator.radius=8", "effects.1.winding.pitch=0 mm", "effects.2.friction.mu=0.3"]


@pytest.fixture
def stub_run(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Put a `run_case` in place of the real one."""

    def install(run_case: Callable[..., Any]) -> None:
        module = types.ModuleType("fiberbend.running.runner")
        module.run_case = run_case  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, "fiberbend.running.runner", module)

    return install


def result(status: str) -> types.SimpleNamespace:
    return types.SimpleNamespace(status=status, reason="because")


def test_validate(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", BASELINE]) == 0
    assert capsys.readouterr().out == f"{BASELINE}: valid\n"


@pytest.mark.parametrize("setting", TERSE)
@pytest.mark.parametrize("command", ["validate", "plan", "run"])
def test_wrong_input_ends_with_1(
    command: str, setting: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([command, BASELINE, "--set", setting]) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(setting.split("=")[0].removesuffix(".mu") + ": ")
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ([], "no command"),
        (["bend"], 'Unknown command "bend"'),
        (["valdate", BASELINE], 'Unknown command "valdate". Did you mean "validate"?'),
        (["run"], 'Command "run" parameter CASE requires an argument'),
        (["validate", BASELINE, BASELINE], f"too many arguments, no use for {BASELINE}"),
        (["validate", BASELINE, "--sett"], "Unknown option: --sett. Did you mean --set?"),
        (["validate", "--case", BASELINE], "Unknown option: --case"),
        (["run", BASELINE, "--no-quiet"], "Unknown option: --no-quiet"),
        (["run", BASELINE, "--overwrite", "--resume"], "--resume and --overwrite together"),
        (["sweep", BASELINE, "-j", "0"], 'Invalid value "0" for -j. Expected a whole number'),
        (["sweep", BASELINE, "--jobs", "x"], "Invalid value for --jobs"),
        (["control", BASELINE, "--suply", "1"], "Unknown option: --suply. Did you mean --supply?"),
        (["control", BASELINE, "--plant", "sectio"], 'Invalid value "sectio" for --plant'),
        (["control", BASELINE, "--steps", "60 deg"], '--steps: "60 deg" alone, expected two val'),
        (
            ["control", BASELINE, "--sine", "60 deg", "--hold", "1 s"],
            '--sine: "60 deg" alone, expected two values, such as ',
        ),
        (["completion", "bsh"], 'Invalid value "bsh" for SHELL'),
    ],
)
def test_wrong_command_line_ends_with_1(
    arguments: list[str], line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(f"fiberbend: {line}")
    assert err.count("\n") == 1


@pytest.mark.parametrize("command", ["validate", "plan", "run", "control"])
def test_a_sweep_is_no_case(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, SWEEP, "--set", "actuator.radius=8"]) == 1
    assert capsys.readouterr() == ("", f"{SWEEP}: this is a sweep: fiberbend sweep {SWEEP}\n")


def test_a_case_is_no_sweep(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", BASELINE, "--out", str(tmp_path / "out")]) == 1
    assert capsys.readouterr() == ("", f"{BASELINE}: this is a case: fiberbend run {BASELINE}\n")
    assert not (tmp_path / "out").exists()


def test_schema(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema"]) == 0
    committed = (ROOT / "cases" / "case.schema.json").read_text(encoding="utf-8")
    assert json.loads(capsys.readouterr().out) == json.loads(committed)


def test_plan_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plan", BASELINE]) == 0
    out = capsys.readouterr().out
    assert out.splitlines()[0].split() == ["effects:", "pressure,", "winding"]
    assert "body (given in the case)" in out


@pytest.mark.parametrize(("status", "code"), [("converged", 0), ("stopped", 0), ("failed", 2)])
def test_exit_code_of_a_run(
    status: str, code: int, stub_run: Callable[..., None], tmp_path: Path
) -> None:
    seen: dict[str, Any] = {}

    def run_case(case: Any, out: Path, **options: Any) -> Any:
        seen.update(options, out=out)
        return result(status)

    stub_run(run_case)
    assert main(["run", BASELINE, "--out", str(tmp_path / "run"), "--overwrite", "--quiet"]) == code
    assert (seen["out"], seen["overwrite"], seen["resume"]) == (tmp_path / "run", True, False)


def test_existing_run_folder_is_kept(
    stub_run: Callable[..., None], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def run_case(case: Any, out: Path, overwrite: bool, **_: Any) -> Any:
        RunFolder.create(out, case, overwrite)
        return result("converged")

    stub_run(run_case)
    command = ["run", BASELINE, "--out", str(tmp_path / "run"), "--quiet"]
    assert main(command) == 0
    (tmp_path / "run" / "history.csv").write_text("precious", encoding="utf-8")
    capsys.readouterr()
    assert main(command) == 1
    assert capsys.readouterr().err == (
        f"{tmp_path / 'run'}: exists, expected a new folder, or --overwrite or --resume\n"
    )
    assert (tmp_path / "run" / "history.csv").read_text(encoding="utf-8") == "precious"
    assert main([*command, "--overwrite"]) == 0
    assert not (tmp_path / "run" / "history.csv").exists()


def test_a_crash_leaves_a_log(
    stub_run: Callable[..., None], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def run_case(case: Any, out: Path, **_: Any) -> Any:
        RunFolder.create(out, case)
        raise ZeroDivisionError("nothing left to divide")

    stub_run(run_case)
    assert main(["run", BASELINE, "--out", str(tmp_path / "run"), "--quiet"]) == 2
    err = capsys.readouterr().err
    assert err.startswith("fiberbend: rank 0 stopped: ZeroDivisionError: nothing left to divide;")
    assert err.count("\n") == 1
    assert "Traceback" in (tmp_path / "run" / "error.rank0.log").read_text(encoding="utf-8")


def test_other_ranks_are_silent(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "1")
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "2")
    assert main(["validate", BASELINE, "--set", "actuator.radius=8"]) == 1
    assert main(["plan", BASELINE]) == 0
    for arguments in (["--help"], ["run", "--help"], ["--version"], ["completion", "bash"]):
        assert main(arguments) == 0
    with pytest.raises(SystemExit):
        main(["bend"])
    assert capsys.readouterr() == ("", "")


def test_several_ranks_get_one_thread_each(monkeypatch: pytest.MonkeyPatch) -> None:
    environment: dict[str, str] = {"OMPI_COMM_WORLD_SIZE": "2"}
    monkeypatch.setattr("os.environ", environment)
    launch.set_threads()
    assert environment["OPENBLAS_NUM_THREADS"] == "1"
    del environment["OPENBLAS_NUM_THREADS"], environment["OMPI_COMM_WORLD_SIZE"]
    launch.set_threads()
    assert "OPENBLAS_NUM_THREADS" not in environment


def test_the_installed_command(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "fiberbend", "validate", str(tmp_path / "none.yaml")]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 1
    assert done.stderr == f"{tmp_path / 'none.yaml'}: no such file, expected a case file\n"
    assert done.stdout == ""


def test_validation_and_plan_load_no_solver() -> None:
    code = (
        "import sys; from fiberbend.cli import main; main(sys.argv[1:]);"
        "print([m for m in ('dolfinx', 'fem', 'gmsh', 'petsc4py', 'mpi4py', 'pint', 'pyvista')"
        " if m in sys.modules])"
    )
    hoops = ["--set", "model=auto", "--set", bad_cases.HOOPS]
    for arguments in (["validate", BASELINE], ["validate", BASELINE, *hoops], ["plan", BASELINE]):
        command = [sys.executable, "-c", code, *arguments]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.stdout.splitlines()[-1] == "[]"


RANKS = """
import sys
from pathlib import Path
from fiberbend.cli import main

for settings in {settings!r}:
    arguments = [item for setting in settings for item in ("--set", setting)]
    assert main(["run", {case!r}, *arguments]) == 1, settings
for path in {files!r}:
    assert main(["run", path]) == 1, path

from mpi4py import MPI
from fiberbend.schema.problems import CaseError
from fiberbend.reader.reader import read_case
from fiberbend.results.folder import RunFolder
from tests.cases import bad_cases

case, comm, out = read_case({case!r}), MPI.COMM_WORLD, Path({out!r})
assert comm.size == 2
RunFolder.create(out, case, comm=comm).write_text("run.json", "kept")
for overwrite in (False, True):
    try:
        folder = RunFolder.create(out, case, overwrite, comm)
        assert overwrite and folder.writes == (comm.rank == 0)
    except CaseError as error:
        assert not overwrite and "exists" in str(error)
print("rank done", flush=True)
sys.exit(1)
"""


@pytest.mark.mpi
def test_every_wrong_input_on_two_ranks(mpirun: Callable[..., Any], tmp_path: Path) -> None:
    files = [str(tmp_path / "none.yaml")]
    for name, (content, _) in bad_cases.BAD_FILES.items():
        (tmp_path / f"{name}.yaml").write_text(content, encoding="utf-8")
        files.append(str(tmp_path / f"{name}.yaml"))
    wrong = [([setting], line) for setting, line in bad_cases.BAD_SETTINGS]
    wrong += bad_cases.UNFIT_MODELS
    settings = [settings for settings, _ in wrong]
    script = tmp_path / "ranks.py"
    script.write_text(
        RANKS.format(settings=settings, case=BASELINE, files=files, out=str(tmp_path / "run")),
        encoding="utf-8",
    )
    done = mpirun(2, [script])
    assert done.returncode == 1
    assert done.stdout.count("rank done") == 2, done.stderr
    for setting, line in wrong:
        lines = [text for text in done.stderr.splitlines() if text.startswith(line)]
        same = sum(other == line for _, other in wrong)
        assert len(lines) >= same, setting
    path = "actuator.radios: unknown key"
    assert done.stderr.count(path) == 1, "one rank speaks"
    assert not (tmp_path / "run" / "run.json").exists()


LATE = """
import sys, time
from fiberbend.running import launch
from fiberbend.cli import entry

if launch.rank() == 0:
    time.sleep(2)
sys.argv[1:] = {arguments!r}
entry()
"""


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["run", BASELINE, "--set", "actuator.radius=8"], "actuator.radius: 8, expected a length"),
        (["bend"], 'fiberbend: Unknown command "bend"'),
    ],
)
def test_rank_0_speaks_though_it_is_last(
    arguments: list[str], line: str, mpirun: Callable[..., Any], tmp_path: Path
) -> None:
    script = tmp_path / "late.py"
    script.write_text(LATE.format(arguments=arguments), encoding="utf-8")
    done = mpirun(2, [script], timeout=60)
    assert done.returncode == 1
    assert done.stderr.count(line) == 1


CRASH = """
import sys, types
from fiberbend.running import launch
from fiberbend.cli import main

def run_case(*arguments, **options):
    from mpi4py import MPI
    if launch.rank() == 1:
        raise RuntimeError("out of luck")
    MPI.COMM_WORLD.Barrier()

module = types.ModuleType("fiberbend.running.runner")
module.run_case = run_case
sys.modules["fiberbend.running.runner"] = module
sys.exit(main(["run", {case!r}, "--out", "run", "--quiet"]))
"""


@pytest.mark.mpi
def test_a_crash_on_one_rank_ends_all(mpirun: Callable[..., Any], tmp_path: Path) -> None:
    script = tmp_path / "crash.py"
    script.write_text(CRASH.format(case=BASELINE), encoding="utf-8")
    done = mpirun(2, [script], cwd=tmp_path, timeout=60)
    assert done.returncode == 2
    assert "fiberbend: rank 1 stopped: RuntimeError: out of luck" in done.stderr
    assert "Traceback" in (tmp_path / "fiberbend.rank1.log").read_text(encoding="utf-8")


def test_resume_reads_the_same_case_only(
    stub_run: Callable[..., None], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def run_case(case: Any, out: Path, overwrite: bool, resume: bool, **_: Any) -> Any:
        (RunFolder.resume if resume else RunFolder.create)(out, case)
        return result("converged")

    stub_run(run_case)
    command = ["run", BASELINE, "--out", str(tmp_path / "run"), "--quiet"]
    assert main([*command, "--resume"]) == 1
    assert "expected a run to resume" in capsys.readouterr().err
    assert main(command) == 0
    assert main([*command, "--resume"]) == 0
    capsys.readouterr()
    assert main([*command, "--resume", "--set", "actuator.wall=3 mm"]) == 1
    assert capsys.readouterr().err == (
        f'actuator.wall: "3 mm", expected "2 mm" as in {tmp_path / "run"}\n'
    )
    assert read_case(tmp_path / "run" / "case.resolved.yaml") == read_case(BASELINE)


def test_starting_mpi_leaves_the_environment_as_it_was() -> None:
    # settings for a process that is alone would cut off the ranks of an mpirun launched from it
    code = (
        "import os; from fiberbend.running import launch; before = dict(os.environ); "
        "launch.start_mpi(); from mpi4py import MPI; "
        "assert MPI.COMM_WORLD.size == 1 and dict(os.environ) == before"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr

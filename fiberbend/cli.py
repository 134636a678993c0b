"""The command `fiberbend`.

Exit codes: 0 done, 1 wrong input, 2 a solution that failed, 128 and its number after a signal.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, NoReturn

from cyclopts import App, CycloptsError, Parameter, UnusedCliTokensError

from fiberbend.commands.examples import EXAMPLES
from fiberbend.process import beside, signals, streams
from fiberbend.reader.arguments import CaseFile, Changes
from fiberbend.running import launch
from fiberbend.running.launch import FAILED, say
from fiberbend.version import __version__
from machine.folders import MachineError

WRONG_INPUT = 1
COMPUTING = ("run", "sweep", "control", "accuracy", "design", "hand")
"""Commands whose results are in a folder, whatever becomes of the lines that they print."""

app = App(
    name="fiberbend",
    help="Simulate soft fiber-reinforced bending actuators.",
    help_format="plaintext",
    help_epilogue="fiberbend COMMAND --help: options and examples of a command",
    version=__version__,
    default_parameter=Parameter(negative=(), show_default=False),
    suppress_keyboard_interrupt=False,
)
# What a command needs is loaded when it is called; the options of a control loop alone are many.
_LOADED = {
    "fiberbend.control.arguments:control": "Bend under feedback control: step response and sine.",
    "fiberbend.commands.plot:plot": (
        "Draw a figure for a paper: curves of runs, sweeps and measured points."
    ),
    "fiberbend.commands.init:init": (
        "Write a commented case file of your own actuator, by options or by questions."
    ),
    "fiberbend.commands.cases:cases": (
        "List the cases that come with the program, or copy some of them into a folder."
    ),
    "fiberbend.commands.materials:materials": (
        "List named rubbers, threads, fabrics and papers, each with its source."
    ),
    "fiberbend.commands.show:show": (
        "Draw the actuator of a case at rest, with its dimensions; nothing is solved."
    ),
    "fiberbend.commands.mesh:mesh": (
        "Write the mesh of a case with its regions, surfaces and fibers."
    ),
    "fiberbend.commands.accuracy:accuracy": (
        "Show what accuracy costs in time: a case by every model and mesh."
    ),
    "fiberbend.commands.fit:fit": (
        "Fit laws of rubber to tests, with errors, stability and what they do to P(θ)."
    ),
    "fiberbend.commands.design:design": (
        "Find the case that does what is wanted, and confirm it by the whole body."
    ),
    "fiberbend.commands.hand:hand": (
        "Close several actuators around what they grasp: forces, moments, pictures."
    ),
    "fiberbend.commands.table:table": (
        "Write the law of a section as a table: energy, force and moment, for rods."
    ),
    "fiberbend.commands.export:export": (
        "Write an actuator as a rod for PyElastica, MuJoCo or SOFA, with a script that runs."
    ),
    "fiberbend.commands.frequencies:frequencies": (
        "Write natural frequencies and modes of an actuator at pressures, as a rod."
    ),
    "fiberbend.commands.report:report": "Write report.html of a run, a sweep or a design again.",
}
for _place, _text in _LOADED.items():
    _name = _place.rpartition(":")[2]
    app.command(_place, name=_name, help=_text, help_epilogue=EXAMPLES[_name])


def entry() -> NoReturn:
    """The command as a process: `main`, with signals, streams and other ranks in order."""
    signals.install()
    streams.guard()
    # the points of a sweep share the cores already
    beside.enable(launch.size() == 1 and sys.argv[1:2] == ["run"])
    try:
        code: Any = main()
    except SystemExit as stop:
        code = stop.code
    if code == WRONG_INPUT:
        launch.let_rank_0_speak(code)
    lost = streams.loss()
    if lost:
        say(f"fiberbend: standard output: {lost}", sys.stderr)
        if not code and sys.argv[1:2] and sys.argv[1] not in COMPUTING:
            code = WRONG_INPUT
    sys.exit(code)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command.

    Args:
        arguments: those of the command line unless given.

    Returns:
        The exit code.

    Raises:
        SystemExit: with code 1 for a command line that cannot be read.
    """
    launch.set_threads()
    tokens = list(sys.argv[1:] if arguments is None else arguments)
    if tokens == ["--version"]:
        # without the 25 ms of what prints help
        return version()
    try:
        if not tokens:
            raise CycloptsError(msg="no command, expected one of those in fiberbend --help")
        code = app(
            tokens,
            console=_console(),
            exit_on_error=False,
            print_error=False,
            result_action="return_value",
        )
    except CycloptsError as error:
        text = _lacking(tokens)
        if not text and isinstance(error, UnusedCliTokensError):
            text = f"too many arguments, no use for {' '.join(error.unused_tokens or ())}"
        raise SystemExit(launch.refuse(f"fiberbend: {text or error}", WRONG_INPUT)) from None
    except Exception as error:
        from fiberbend.schema.problems import CaseError

        if isinstance(error, (CaseError, MachineError)):
            return launch.refuse(str(error), WRONG_INPUT)
        if isinstance(error, OSError) and error.filename is not None:
            return launch.refuse(f"{error.filename}: {error.strerror}", WRONG_INPUT)
        raise
    return code or 0


def _lacking(tokens: list[str]) -> str:
    """What an option of `control` lacks, which takes the next one for its second value."""
    if tokens[:1] != ["control"]:
        return ""
    from fiberbend.control.arguments import lacks_value

    return lacks_value(tokens)


@app.command(
    help_epilogue="""Examples:
  fiberbend validate cases/free_bending.yaml
  fiberbend validate cases/free_bending.yaml --set actuator.wall="3 mm"
"""
)
def validate(case: CaseFile, /, *, settings: Changes = ()) -> None:
    """Check a case."""
    from fiberbend.reader.reader import read_case

    read_case(case, settings)
    say(f"{case}: valid")


@app.command(
    help_epilogue="""Examples:
  fiberbend plan cases/free_bending.yaml
  fiberbend plan cases/free_bending.yaml --set mesh.axial="3 mm"
"""
)
def plan(case: CaseFile, /, *, settings: Changes = (), force: bool = False) -> int:
    """Print what a run would do: its model, size, time, memory and errors.

    Args:
        case: Case file.
        settings: Changes to it.
        force: Plan even if there is not enough memory.
    """
    from fiberbend.plan.plan import make_plan
    from fiberbend.reader.reader import read_case

    made = make_plan(read_case(case, settings))
    for line in made.lines():
        say(line)
    if made.refusal and not force:
        say(made.refusal, sys.stderr)
        return WRONG_INPUT
    return 0


@app.command(
    help_epilogue="""Examples:
  fiberbend run cases/section.yaml
  fiberbend run cases/section.yaml --verbose
  fiberbend run cases/section.yaml --out runs/thick --set actuator.wall="3 mm"
  fiberbend run cases/section.yaml --quiet --overwrite
  mpirun -n 2 fiberbend run cases/free_bending.yaml --resume
"""
)
def run(
    case: CaseFile,
    /,
    *,
    settings: Changes = (),
    out: Path | None = None,
    overwrite: bool = False,
    resume: bool = False,
    quiet: bool = False,
    verbose: Annotated[bool, Parameter(name=("--verbose", "-v"))] = False,
    force: bool = False,
) -> int:
    """Solve a case, and print what it answers.

    Its folder gets the curves (history.csv), how they were computed (run.json),
    what was printed (run.log), and report.html, pictures and fields as asked.

    Args:
        case: Case file.
        settings: Changes to it.
        out: Run folder; runs/CASE unless given.
        overwrite: Replace an earlier run.
        resume: Go on with an interrupted run.
        quiet: No progress; the answer alone.
        verbose: Print phases, cut-backs, counts and comparisons with other models too.
        force: Run even if there is not enough memory.
    """
    from fiberbend.reader.reader import read_case
    from fiberbend.results.folder import REPORT
    from fiberbend.running.progress import Progress
    from fiberbend.schema.problems import CaseError

    if overwrite and resume:
        raise CycloptsError(msg="--resume and --overwrite together, expected one of them")
    if quiet and verbose:
        raise CycloptsError(msg="--quiet and --verbose together, expected one of them")
    checked = read_case(case, settings)
    launch.prepare_drawing(checked)
    folder = out or Path("runs") / case.stem
    progress = Progress(quiet=quiet, verbose=verbose, answers=True)
    try:
        launch.start_mpi()
        from fiberbend.running.runner import run_case

        with signals.raising():
            result = run_case(
                checked,
                folder,
                overwrite=overwrite,
                progress=progress,
                resume=resume,
                force=force,
            )
    except CaseError:
        raise
    except KeyboardInterrupt as error:
        progress.close()
        return launch.stopped(signals.stop_of(error))
    except BaseException as error:
        progress.close()
        if isinstance(error, MachineError):
            raise
        return launch.crash(error, folder)
    progress.close()
    if result.status != "converged":
        say(f"{result.status}: {result.reason}", sys.stderr)
    say(f"results in {folder}")
    if (folder / REPORT).exists():
        say(f"report in {folder / REPORT}")
    return FAILED if result.status == "failed" else 0


def _count(_type: type, number: int | None) -> None:
    if number is not None and number < 1:
        raise ValueError("Expected a whole number from 1 on.")


@app.command(
    help_epilogue="""Examples:
  fiberbend sweep cases/sweeps/radius_length_wall.yaml --dry-run -j 2
  fiberbend sweep cases/sweeps/radius_length_wall.yaml -j 2
  fiberbend sweep cases/sweeps/table1.yaml --only wall=2mm --only radius=1cm
  fiberbend sweep cases/sweeps/angle_at_pressure.yaml --set mesh.section=3
  fiberbend sweep cases/sweeps/radius_length_wall.yaml -j 2 --retry
  mpirun -n 64 fiberbend sweep cases/sweeps/radius_length_wall.yaml

What a file asks for under "report" leads its table, trends and maps:
  angles: [90 deg]     pressure at an angle, column pressure_90deg_kPa
  pressures: [60 kPa]  angle at a pressure, column angle_60kPa_deg
  force_at: 100 kPa    blocked force, columns blocked_force_N and
                       blocked_force_model, which says whose force it is
The line of the paper is drawn with "set: {compare: [paper]}". A point has a
report of its own with "set: {output.report: true}"; pictures and fields alike.
"""
)
def sweep(
    file: Annotated[Path, Parameter(name="SWEEP")],
    /,
    *,
    settings: Changes = (),
    out: Path | None = None,
    jobs: Annotated[int | None, Parameter(name=("--jobs", "-j"), validator=_count)] = None,
    retry: bool = False,
    force: bool = False,
    only: Annotated[
        tuple[str, ...],
        Parameter(name="--only", metavar="FIELD=VALUE", consume_multiple=False),
    ] = (),
    dry_run: bool = False,
) -> int:
    """Solve a case at many points, in a folder; started again, it goes on.

    Args:
        file: Sweep file, YAML.
        settings: Changes to the base case.
        out: Folder; runs/SWEEP unless given.
        jobs: Processes that solve at once; 1 by default. Under mpirun, all ranks but one do.
        retry: Run failed points again.
        force: Run even if there is not enough memory for all jobs.
        only: Solve the points with this value of a varied field, such as wall=2mm; repeatable.
        dry_run: Print points, models, time and memory; solve and write nothing.
    """
    from fiberbend.schema.problems import CaseError
    from fiberbend.sweep.command import run_sweep

    folder = out or Path("runs") / file.stem
    try:
        with signals.raising():
            return run_sweep(
                file, folder, settings, jobs, retry, force, say=say, only=only, dry=dry_run
            )
    except (CaseError, MachineError):
        raise
    except KeyboardInterrupt as error:
        return launch.stopped(signals.stop_of(error))
    except Exception as error:
        return launch.crash(error, folder)


@app.command(
    help_epilogue="""Examples:
  fiberbend schema > case.schema.json
"""
)
def schema() -> None:
    """Print the JSON schema of a case, for editors."""
    import json

    from fiberbend.reader.json_schema import json_schema

    say(json.dumps(json_schema(), indent=2, ensure_ascii=False))


@app.command(
    help_epilogue="""Examples:
  source <(fiberbend completion bash)
  fiberbend completion zsh > ~/.zfunc/_fiberbend
  fiberbend completion fish > ~/.config/fish/completions/fiberbend.fish
"""
)
def completion(shell: Literal["bash", "zsh", "fish"], /) -> None:
    """Print a script that lets a shell complete commands, options and files.

    Args:
        shell: Your shell.
    """
    say(app.generate_completion(shell=shell).rstrip("\n"))


@app.command(
    help_epilogue="""Examples:
  fiberbend version
"""
)
def version() -> int:
    """Print the version."""
    say(__version__)
    return 0


def _console() -> Any:
    """Where help goes: of several ranks one speaks."""
    if launch.rank() == 0:
        return None
    from rich.console import Console

    return Console(quiet=True)

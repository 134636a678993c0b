"""The command `fiberbend`.

Exit codes: 0 done, 1 wrong input, 2 a solution that failed.
"""

from __future__ import annotations

import argparse
import json
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

from fiberbend.control.settings import add_options
from fiberbend.running import launch
from fiberbend.version import __version__

WRONG_INPUT = 1
FAILED = 2


class _Parser(argparse.ArgumentParser):
    """Argparse ends with code 2 on wrong input; here that stands for a failed solution."""

    def error(self, message: str) -> NoReturn:
        _say(f"{self.prog}: {message}", sys.stderr)
        raise SystemExit(WRONG_INPUT)

    def _print_message(self, message: str, file: Any = None) -> None:
        if message:
            _say(message.rstrip("\n"), file or sys.stdout)


def entry() -> NoReturn:
    """The installed command: `main`, and under mpirun an end that leaves rank 0 time to speak."""
    try:
        code: Any = main()
    except SystemExit as stop:
        code = stop.code
    if code == WRONG_INPUT:
        launch.let_rank_0_speak()
    sys.exit(code)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command.

    Args:
        arguments: those of the command line unless given.

    Returns:
        The exit code.
    """
    launch.set_threads()
    options = _parser().parse_args(arguments)
    if options.command == "version":
        _say(__version__)
        return 0
    from fiberbend.schema.problems import CaseError

    try:
        code: int = options.action(options)
        return code
    except CaseError as error:
        # Every rank finds the same and ends by itself, MPI or not; one of them speaks.
        _say(str(error), sys.stderr)
        return WRONG_INPUT


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="fiberbend", description="Simulate fiber-reinforced bending actuators.")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    case = _Parser(add_help=False)
    case.add_argument("case", metavar="CASE", help="case file, YAML")
    case.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="PATH=VALUE",
        dest="settings",
        help='change the case, such as effects.0.pressure.to="150 kPa"; repeatable',
    )
    validate = commands.add_parser("validate", parents=[case], help="check a case")
    validate.set_defaults(action=_validate)
    plan = commands.add_parser("plan", parents=[case], help="say what a run would do")
    plan.set_defaults(action=_plan)
    run = commands.add_parser("run", parents=[case], help="solve a case")
    run.add_argument("--out", metavar="DIR", type=Path, help="run folder; runs/CASE unless given")
    existing = run.add_mutually_exclusive_group()
    existing.add_argument("--overwrite", action="store_true", help="replace an earlier run")
    existing.add_argument("--resume", action="store_true", help="go on with an interrupted run")
    run.add_argument("--quiet", action="store_true", help="no progress")
    run.set_defaults(action=_run)
    sweep = commands.add_parser("sweep", help="solve a case at many points")
    sweep.add_argument("sweep", metavar="SWEEP", type=Path, help="sweep file, YAML")
    sweep.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="PATH=VALUE",
        dest="settings",
        help="change the base case of all points; repeatable",
    )
    sweep.add_argument("--out", metavar="DIR", type=Path, help="folder; runs/SWEEP unless given")
    sweep.add_argument("-j", "--jobs", type=_count, default=1, help="processes that solve at once")
    sweep.add_argument("--retry", action="store_true", help="run failed points again")
    sweep.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    sweep.set_defaults(action=_sweep)
    control = commands.add_parser(
        "control", parents=[case], help="bend under feedback control: step response and sine"
    )
    control.add_argument("--out", metavar="DIR", type=Path, help="folder; runs/CASE_control")
    control.add_argument("--overwrite", action="store_true", help="replace an earlier one")
    add_options(control)
    control.set_defaults(action=_control)
    schema = commands.add_parser("schema", help="print the JSON schema of a case")
    schema.set_defaults(action=_schema)
    commands.add_parser("version", help="print the version")
    return parser


def _validate(options: argparse.Namespace) -> int:
    from fiberbend.reader.reader import read_case

    read_case(options.case, options.settings)
    _say(f"{options.case}: valid")
    return 0


def _plan(options: argparse.Namespace) -> int:
    from fiberbend.plan.plan import make_plan
    from fiberbend.reader.reader import read_case

    for line in make_plan(read_case(options.case, options.settings)).lines():
        _say(line)
    return 0


def _schema(options: argparse.Namespace) -> int:
    from fiberbend.reader.reader import json_schema

    _say(json.dumps(json_schema(), indent=2, ensure_ascii=False))
    return 0


def _run(options: argparse.Namespace) -> int:
    from fiberbend.reader.reader import read_case
    from fiberbend.running.progress import Progress
    from fiberbend.schema.problems import CaseError

    case = read_case(options.case, options.settings)
    out = options.out or Path("runs") / Path(options.case).stem
    progress = Progress(quiet=options.quiet)
    try:
        launch.start_mpi()
        from fiberbend.running.runner import run_case

        result = run_case(
            case, out, overwrite=options.overwrite, progress=progress, resume=options.resume
        )
    except CaseError:
        raise
    except BaseException as error:
        progress.close()
        return _crash(error, out)
    progress.close()
    if result.status != "converged":
        _say(f"{result.status}: {result.reason}", sys.stderr)
    _say(f"results in {out}")
    return FAILED if result.status == "failed" else 0


def _sweep(options: argparse.Namespace) -> int:
    from fiberbend.schema.problems import CaseError
    from fiberbend.sweep.command import INTERRUPTED, run_sweep, run_worker

    out = options.out or Path("runs") / options.sweep.stem
    try:
        if options.worker:
            launch.start_mpi()
            return run_worker(options.sweep, out, options.settings)
        return run_sweep(
            options.sweep, out, options.settings, options.jobs, options.retry, say=_say
        )
    except CaseError:
        raise
    except KeyboardInterrupt:
        return INTERRUPTED
    except Exception as error:
        return _crash(error, out)


def _control(options: argparse.Namespace) -> int:
    from fiberbend.control.settings import read_settings
    from fiberbend.reader.reader import read_case
    from fiberbend.schema.problems import CaseError

    case, settings = read_case(options.case, options.settings), read_settings(options)
    out = options.out or Path("runs") / f"{Path(options.case).stem}_control"
    try:
        launch.start_mpi()
        from fiberbend.control.command import run_control

        result = run_control(case, settings, out, options.overwrite)
    except CaseError:
        raise
    except BaseException as error:
        return _crash(error, out)
    for line in result.lines():
        _say(line)
    _say(f"results in {out}")
    return 0


def _crash(error: BaseException, out: Path) -> int:
    """Leave a log and end all ranks: those that wait for this one would wait for ever."""
    rank = launch.rank()
    log = out / f"error.rank{rank}.log" if out.is_dir() else Path(f"fiberbend.rank{rank}.log")
    what = traceback.format_exception_only(error)[-1].strip().splitlines()[0]
    try:
        log.write_text("".join(traceback.format_exception(error)), encoding="utf-8")
        where = f"; see {log}"
    except OSError:
        where = ""
    print(f"fiberbend: rank {rank} stopped: {what}{where}", file=sys.stderr, flush=True)
    if launch.size() > 1:
        from mpi4py import MPI

        MPI.COMM_WORLD.Abort(FAILED)
    return FAILED


def _count(text: str) -> int:
    """A whole number from 1 on."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text}, expected a whole number from 1 on")
    return int(text)


def _say(text: str, stream: Any = None) -> None:
    if launch.rank() == 0:
        print(text, file=stream or sys.stdout, flush=True)

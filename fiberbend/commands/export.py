"""The command `fiberbend export`: a rod's numbers for robot simulators."""

from __future__ import annotations

import os
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from fiberbend.columns import PRESSURE
from fiberbend.running import launch
from fiberbend.running.launch import say, settle_folders
from fiberbend.schema.problems import CaseError, Problem, found, meant

if TYPE_CHECKING:
    from fiberbend.case.case import Case
    from fiberbend.export.targets import Target

_CASES = (".yaml", ".yml")
_WHOLE = "converged"


def export(
    run: Annotated[Path, Parameter(name="RUN")],
    /,
    *,
    to: Annotated[str, Parameter(metavar="PROGRAM")],
    density: Annotated[
        tuple[str, ...], Parameter(metavar="PART=VALUE", consume_multiple=False)
    ] = (),
    out: Annotated[Path | None, Parameter(metavar="FOLDER")] = None,
    overwrite: bool = False,
) -> int:
    """Write an actuator as a rod for PyElastica, MuJoCo or SOFA: numbers and a script that runs.

    Rest curvature and stretch by the pressure, bending, stretching and twisting stiffness, mass
    and geometry go into rod.json; the other files of a program read it. They are those of the
    section of the run's case, which is solved for that; loads but for the pressure are left out.

    Args:
        run: Folder of a run, or a case file.
        to: pyelastica, mujoco, sofa or json. SOFA's scene was never run in SOFA.
        density: Density of a part whose material has none, such as floor="1.3 g/cm^3"; repeatable.
        out: Folder of the files; exports/RUN-PROGRAM unless given.
        overwrite: Replace files that are there.
    """
    from fiberbend.export.targets import TARGETS

    if to not in TARGETS:
        names = ", ".join(TARGETS)
        text = f"{found(to)}, expected one of {names}{meant(to, list(TARGETS))}"
        raise CaseError([Problem("--to", text)])
    target = TARGETS[to]
    case, reached = _case(run)
    densities = _densities(case, density)
    folder = out or Path("exports") / f"{run.stem if run.suffix in _CASES else run.name}-{to}"
    files = [folder / name for name in target.names]
    taken = [path for path in files if path.exists()]
    if taken and not overwrite:
        text = "exists, expected a new folder by --out, or --overwrite"
        raise CaseError([Problem(str(path), text) for path in taken])
    _check_folder(folder)
    settle_folders()
    _check(target, case, densities)
    launch.start_mpi()
    from fiberbend.export import record as made
    from fiberbend.export.hand import facts, handed
    from fiberbend.export.targets import DATA

    record = made.record_of(handed(case, densities, reached))
    contents = {DATA: made.text(record), **target.contents(record)}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in contents.items():
            (folder / name).write_text(content, encoding="utf-8")
    except OSError as stop:
        text = f"{stop.strerror}, expected a folder that can be written"
        raise CaseError([Problem(str(folder), text)]) from None
    say(f"Rod for {to}: {case.title or run}")
    for line in facts(record):
        say(f"  {line}")
    if reached is not None:
        say("  the run did not come to its end: the file is of the pressures that it has reached")
    say(f"files: {', '.join(str(path) for path in files)}")
    for name in target.scripts:
        if target.tested:
            most = record["section"]["pressure_kPa"][-1]
            say(f"next:  python {shlex.quote(str(folder / name))} --pressure {most / 2:.4g}")
        else:
            say(
                f"next:  runSofa {shlex.quote(str(folder / name))} (never run in {to} by the tests)"
            )
    return 0


def _check_folder(folder: Path) -> None:
    """Refuse a folder that cannot be made before anything is solved.

    Raises:
        CaseError: what is there of its path is no folder, or cannot be written.
    """
    there = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    if not there.is_dir() or not os.access(there, os.W_OK | os.X_OK):
        what = "cannot be written" if there.is_dir() else "is a file"
        text = f"{there} {what}, expected a folder that can be written"
        raise CaseError([Problem(str(folder), text)])


def _check(target: Target, case: Case, densities: dict[str, float]) -> None:
    """Refuse what is known to be missing before anything is solved.

    Raises:
        CaseError: masses that the program needs, or no section to solve.
    """
    from fiberbend.export.hand import density_words, law_case, weighed_case, without_density

    law_case(case)
    missing = without_density(weighed_case(case, densities))
    if target.moves and missing:
        raise CaseError([Problem("mass", f"{density_words(missing)}; --to json takes none")])


def _case(run: Path) -> tuple[Case, float | None]:
    """The case of a run, or of a file, and the pressure at which a run ended early, MPa.

    Raises:
        CaseError: neither is there, or the run has reached no pressure.
    """
    if run.suffix in _CASES and not run.is_dir():
        from fiberbend.reader.reader import read_case

        return read_case(run), None
    from fiberbend.api.loading import load
    from fiberbend.api.result import Result

    result = load(run)
    if not isinstance(result, Result) or result.case is None:
        text = "is the folder of a sweep, expected that of a run, such as one of its points"
        raise CaseError([Problem(str(run), text)])
    if result.status == _WHOLE:
        return result.case, None
    reached = max((float(row.get(PRESSURE) or 0.0) for row in result.rows), default=0.0)
    if not reached > 0:
        text = f"the run is {result.status} and has reached no pressure, expected one that has"
        raise CaseError([Problem(str(run), f"{text}, or its case file")])
    return result.case, 1e-3 * reached


def _densities(case: Case, given: tuple[str, ...]) -> dict[str, float]:
    """Densities by part, t/mm³.

    Raises:
        CaseError: no such part, or no density.
    """
    from fiberbend.export.hand import without_density
    from fiberbend.schema.units import parse

    unknown = without_density(case)
    parts = [part for part, spec in dict(case.materials).items() if spec is not None]
    densities = {}
    for item in given:
        part, _, value = item.partition("=")
        if part not in parts:
            wanted = f"expected PART=VALUE with one of {', '.join(parts)}"
            raise CaseError([Problem("--density", f"{found(item)}, {wanted}")])
        try:
            densities[part] = parse(value, "density")
        except ValueError as error:
            raise CaseError([Problem("--density", f"{found(item)}, {error}")]) from None
        if part not in unknown:
            text = f"{found(item)}, the case knows the density of {part}, expected none beside it"
            raise CaseError([Problem("--density", text)])
        if not densities[part] > 0:
            raise CaseError([Problem("--density", f"{found(item)}, expected more than zero")])
    return densities

"""The command `fiberbend frequencies`: natural frequencies and modes of an actuator as a rod."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from fiberbend.reader.arguments import CaseFile, Changes
from fiberbend.running import launch
from fiberbend.running.launch import say, settle_folders
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.schema.units import parse

if TYPE_CHECKING:
    from fiberbend.slender.frequencies import Vibration

FILES = ("frequencies.csv", "modes.png")
_PARTS = 4
"""Steps from no pressure to the case's, where none is asked for."""
_MOST = 50


def frequencies(
    case: CaseFile,
    /,
    *,
    settings: Changes = (),
    at: Annotated[tuple[str, ...], Parameter(metavar="PRESSURE", negative="")] = (),
    modes: Annotated[int, Parameter(metavar="NUMBER")] = 3,
    out: Annotated[Path | None, Parameter(metavar="FOLDER")] = None,
    overwrite: bool = False,
    open_it: Annotated[bool, Parameter(name="--open")] = False,
) -> int:
    """Write the natural frequencies of an actuator, as a rod, at pressures.

    Small undamped vibrations about the state at rest under weight, loads and pressure, in the
    plane of bending; the pressure does not change meanwhile. The case is taken as one of model rod.

    Args:
        case: Case file with an effect pressure; its materials have densities.
        settings: Changes to it.
        at: A pressure, from none to that of the case, such as "30 kPa"; repeatable. From none
            to all of it in quarters unless given.
        modes: How many at each pressure.
        out: Folder of frequencies.csv and modes.png; frequencies/CASE unless given.
        overwrite: Replace files that are there.
        open_it: Show the picture.
    """
    from fiberbend.reader.reader import read_case

    if not 1 <= modes <= _MOST:
        raise CaseError([Problem("--modes", f"{modes}, expected from 1 to {_MOST}")])
    checked = read_case(case, [*settings, "model=rod"])
    pressures = _pressures(at, checked.inflation.to if checked.inflation else None)
    folder = out or Path("frequencies") / case.stem
    files = [folder / name for name in FILES]
    taken = [path for path in files if path.exists()]
    if taken and not overwrite:
        text = "exists, expected a new folder by --out, or --overwrite"
        raise CaseError([Problem(str(path), text) for path in taken])
    settle_folders()
    launch.start_mpi()
    import numpy as np

    from fiberbend.drawing.moving.modes import plot_modes
    from fiberbend.drawing.page import own_style
    from fiberbend.slender.frequencies import vibrations

    found = vibrations(checked, pressures, modes)
    for line in _told(found):
        say(line)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        files[0].write_text(_text(found), encoding="utf-8")
        with own_style():
            plot_modes(
                1e3 * np.array(pressures),
                np.array([each.frequencies for each in found]),
                [each.line for each in found],
                [each.moved for each in found],
                files[1],
                checked.title,
            )
    except OSError as stop:
        raise CaseError([Problem(str(folder), f"{stop.strerror}, expected a folder")]) from None
    say(f"table: {files[0]}")
    say(f"picture: {files[1]}")
    if open_it:
        from fiberbend.commands.opening import open_file

        open_file(files[1])
    return 0


def _pressures(texts: Sequence[str], to: float | None) -> list[float]:
    """In MPa, rising."""
    if not texts:
        return [(to or 0.0) * part / _PARTS for part in range(_PARTS + 1)]
    found, problems = [], []
    for text in texts:
        try:
            found.append(parse(text, "pressure"))
        except ValueError as error:
            problems.append(Problem("--at", f'"{text}", {error}'))
    if problems:
        raise CaseError(problems)
    return sorted(set(found))


def _told(found: Sequence[Vibration]) -> list[str]:
    """The table as lines."""
    count = len(found[0].frequencies)
    head = "".join(f"{f'mode {number + 1}':>12}" for number in range(count))
    lines = [
        f"{'pressure':>12}{'angle':>11}{head}",
        f"{'kPa':>12}{'°':>11}" + f"{'Hz':>12}" * count,
    ]
    for each in found:
        values = "".join(
            f"{frequency:12.4g}" if frequency >= 0 else f"{'unstable':>12}"
            for frequency in each.frequencies
        )
        lines.append(f"{1e3 * each.pressure:12.4g}{math.degrees(each.angle):11.2f}{values}")
    unstable = [each for each in found if (each.frequencies < 0).any()]
    for each in unstable:
        rate = 2 * math.pi * -float(each.frequencies.min())
        lines.append(
            f"at {1e3 * each.pressure:.4g} kPa the state is unstable: what disturbs it grows by "
            f"exp({rate:.3g} t/s)"
        )
    return lines


def _text(found: Sequence[Vibration]) -> str:
    """The table as CSV: a line for each mode."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["pressure_kPa", "angle_deg", "mode", "frequency_Hz", "growth_per_s"])
    for each in found:
        for number, frequency in enumerate(each.frequencies.tolist()):
            stable = frequency >= 0
            writer.writerow(
                [
                    f"{1e3 * each.pressure:.9g}",
                    f"{math.degrees(each.angle):.9g}",
                    number + 1,
                    f"{frequency:.9g}" if stable else "",
                    "" if stable else f"{-2 * math.pi * frequency:.9g}",
                ]
            )
    return out.getvalue()

"""The command `fiberbend fit`: laws of rubber from tests."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from fiberbend.running.launch import say, settle_folders
from fiberbend.schema.problems import CaseError, Problem

if TYPE_CHECKING:
    from fiberbend.case.case import Case
    from fiberbend.fit.comparison import Asked, Comparison
    from fiberbend.tensile.reading import ModeName

ModeOption = Literal["uniaxial", "pure-shear", "equibiaxial"]
_FILES = Parameter(consume_multiple=False, metavar="CSV")
_LAW = (
    "Law, with all its terms or with a number of them such as yeoh-2; several between commas or "
    "repeated; the usual ones by default."
)
_AS = "What strains and stresses are whose names do not say it."
_UPTO = 'Greatest stretch that is fitted, such as "stretch 1.5" or "strain 50 %".'
_CYCLE = "Which loading of a test that goes back and forth; 1 by default, 0 for all rows."
_OUT = "Material file; NAME.yaml of the first test by default. Its picture is NAME.png."


def fit(
    *tests: Annotated[Path, Parameter(name="CSV")],
    uniaxial: Annotated[tuple[Path, ...], _FILES] = (),
    pure_shear: Annotated[tuple[Path, ...], _FILES] = (),
    equibiaxial: Annotated[tuple[Path, ...], _FILES] = (),
    law: Annotated[tuple[str, ...], Parameter(consume_multiple=False, help=_LAW)] = (),
    stretch: Annotated[str, Parameter(metavar="COLUMN")] = "",
    strain: Annotated[str, Parameter(metavar="COLUMN")] = "",
    stress: Annotated[str, Parameter(metavar="COLUMN")] = "",
    meant: Annotated[
        Literal["engineering", "true"] | None, Parameter(name="--as", help=_AS)
    ] = None,
    gauge: Annotated[str, Parameter(metavar="LENGTH")] = "",
    width: Annotated[str, Parameter(metavar="LENGTH")] = "",
    thickness: Annotated[str, Parameter(metavar="LENGTH")] = "",
    cycle: Annotated[int, Parameter(metavar="N", help=_CYCLE)] = 1,
    since: Annotated[str, Parameter(name="--from", metavar="LIMIT")] = "",
    upto: Annotated[str, Parameter(metavar="LIMIT", help=_UPTO)] = "",
    decimal: Annotated[Literal[".", ","] | None, Parameter(metavar="MARK")] = None,
    weights: Literal["plain", "relative"] = "plain",
    unstable: bool = False,
    only: Annotated[tuple[ModeOption, ...], Parameter(consume_multiple=False)] = (),
    density: str = "",
    case: Annotated[Path | None, Parameter(metavar="CASE")] = None,
    part: str = "wall",
    refits: Annotated[int, Parameter(metavar="N")] = 0,
    out: Annotated[Path | None, Parameter(help=_OUT)] = None,
    overwrite: bool = False,
    open_it: Annotated[bool, Parameter(name="--open")] = False,
) -> int:
    """Fit laws of rubber to tests, and say how far they hold.

    Prints the laws with errors, stability and what they say of modes that were not
    measured; writes the best one as a material file, and a picture. With --case it
    solves the case, and says what the errors do to the pressure at its angles.

    Args:
        tests: Uniaxial tests, files of columns, or names of tests that come with the program.
        uniaxial: Uniaxial test; repeatable.
        pure_shear: Test in pure shear, a wide strip; repeatable.
        equibiaxial: Equibiaxial test; repeatable.
        law: Law.
        stretch: Column of stretches, by name or number, such as "2".
        strain: Column of strains, such as "elongation [%]".
        stress: Column of stresses, such as "true stress [MPa]".
        meant: What strains and stresses are.
        gauge: Length at rest of what is pulled; displacements are read, --strain names them.
        width: Width at rest; forces are read with --thickness, --stress names them.
        thickness: Thickness at rest.
        cycle: Loading.
        since: Least stretch that is fitted.
        upto: Greatest stretch that is fitted.
        decimal: Mark before decimals; found by default.
        weights: Points of a mode count alike, or by one over their stress.
        only: Fit tests of this mode alone, and compare the others; repeatable.
        unstable: Do not ask that the law is stable up to the greatest stretch.
        density: Density for the material file, such as "1.07 g/cm^3".
        case: Case file of uniform bending whose pressure is told with its error.
        part: Part of the case that is made of this rubber; the wall by default.
        refits: Refits to resampled tests that are solved for --case too.
        out: Material file.
        overwrite: Replace files that are there.
        open_it: Show the picture.
    """
    from fiberbend.fit.comparison import Asked, compared, law_names
    from fiberbend.fit.material_file import check_density
    from fiberbend.fit.words import case_lines, lines
    from fiberbend.tensile.reading import Wanted

    modes: tuple[tuple[ModeName, tuple[Path, ...]], ...] = (
        ("uniaxial", (*tests, *uniaxial)),
        ("pure-shear", pure_shear),
        ("equibiaxial", equibiaxial),
    )
    asked = Asked(
        tuple((mode, path) for mode, paths in modes for path in paths),
        law_names(law),
        Wanted(
            stretch=stretch,
            strain=strain,
            stress=stress,
            meant=meant,
            gauge=_length("--gauge", gauge),
            area=_area(width, thickness),
            cycle=_count("--cycle", cycle),
            least=_limit("--from", since),
            most=_limit("--upto", upto),
            decimal=decimal,
        ),
        weights,
        not unstable,
        only,
    )
    if _count("--refits", refits) and case is None:
        raise CaseError([Problem("--refits", "no effect without --case, expected a case")])
    check_density("--density", density)
    files = _targets(asked, out, case is not None, overwrite)
    settle_folders()
    checked = None if case is None else _case(case, part)
    found = compared(asked)
    for line in lines(found):
        say(line)
    if checked is not None:
        say("")
        _band(found, checked, part, refits, files[2])
    _write(found, files[0], files[1], density)
    say("")
    say(f"material of {found.best.form.name}: {files[0]}; in a case one of")
    for line in case_lines(found.best, part, files[0]):
        say(line)
    say(f"picture: {files[1]}")
    if open_it:
        from fiberbend.commands.opening import open_file

        open_file(files[1])
    return 0


def _case(path: Path, part: str) -> Case:
    """The case, which has the part.

    Raises:
        CaseError: it is wrong, or has no such part.
    """
    from fiberbend.reader.reader import read_case

    case = read_case(path)
    there = [name for name, spec in case.materials if spec is not None]
    if part not in there:
        raise CaseError([Problem("--part", f"{part!r}, expected one of {', '.join(there)}")])
    return case


def _band(found: Comparison, case: Case, part: str, refits: int, target: Path) -> None:
    """Solve a case, print its pressures with their errors, and draw them."""
    from fiberbend.fit.band import band_of, pressures
    from fiberbend.fit.band_words import band_lines
    from fiberbend.fit.picture import draw_band
    from fiberbend.running import launch

    launch.start_mpi()
    band = band_of(case, part, found.best, refits)
    others = {
        fit.form.name: 1e3 * pressures(case, part, fit.material, band.angles)[0]
        for fit in found.fits[1:]
        if not fit.unsettled
    }
    for line in band_lines(band, others, found.reach):
        say(line)
    _save(draw_band(band, others), target)
    say(f"picture: {target}")


def _write(found: Comparison, material: Path, picture: Path, density: str) -> None:
    from fiberbend.fit.material_file import text
    from fiberbend.fit.picture import draw

    try:
        material.parent.mkdir(parents=True, exist_ok=True)
        material.write_text(text(found, found.best, density), encoding="utf-8")
    except OSError as error:
        raise CaseError([Problem(str(material), f"{error.strerror}, expected a file")]) from None
    _save(draw(found), picture)


def _save(figure: object, target: Path) -> None:
    from fiberbend.drawing.page import save

    try:
        save(figure, target)
    except OSError as error:
        raise CaseError([Problem(str(target), f"{error.strerror}, expected a file")]) from None


def _targets(asked: Asked, out: Path | None, band: bool, overwrite: bool) -> list[Path]:
    """Material file, its picture, and that of the pressure; none of them exists.

    Raises:
        CaseError: one does, or the name is none of a material file.
    """
    first = asked.files[0][1].stem if asked.files else "rubber"
    material = out or Path(f"{first}.yaml")
    if material.suffix not in (".yaml", ".yml"):
        raise CaseError([Problem("--out", f'"{material}", expected a name that ends in .yaml')])
    files = [material, material.with_suffix(".png")]
    files.append(material.with_name(f"{material.stem}_pressure.png"))
    taken = [path for path in files[: 3 if band else 2] if path.exists()]
    if taken and not overwrite:
        text = "exists, expected a new name by --out, or --overwrite"
        raise CaseError([Problem(str(path), text) for path in taken])
    return files


def _limit(option: str, text: str) -> float | None:
    from fiberbend.tensile.reading import limit

    if not text:
        return None
    try:
        return limit(text)
    except ValueError as error:
        raise CaseError([Problem(option, f'"{text}", {error}')]) from None


def _length(option: str, text: str) -> float | None:
    from fiberbend.schema.units import parse

    if not text:
        return None
    try:
        value = parse(text, "length")
    except ValueError as error:
        raise CaseError([Problem(option, f'"{text}", {error}')]) from None
    if not value > 0:
        raise CaseError([Problem(option, f'"{text}", expected a length above zero')])
    return value


def _area(width: str, thickness: str) -> float | None:
    """The cross-section in mm²."""
    across, through = _length("--width", width), _length("--thickness", thickness)
    if (across is None) != (through is None):
        raise CaseError([Problem("--width", "expected --width and --thickness together")])
    return None if across is None or through is None else across * through


def _count(option: str, number: int) -> int:
    if number < 0:
        raise CaseError([Problem(option, f"{number}, expected a whole number from 0 on")])
    return number

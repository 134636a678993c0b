"""`fiberbend.fit`, and what it returns."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args

from fiberbend.api.calls import TURN, AnyCase, Settings
from fiberbend.fit.comparison import Asked, Comparison, compared, law_names
from fiberbend.notebook import blocks
from fiberbend.reader.reader import as_case
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.schema.units import parse
from fiberbend.tensile.columns import Meant
from fiberbend.tensile.reading import ModeName, Wanted, limit

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from fiberbend.fit.band import Band
    from materials.fit.fit import Fit
    from materials.material import Material

Files = Sequence[Path | str] | Path | str
"""A file, or several."""


class Fitted:
    """Laws fitted to tests of a rubber; what is asked of one law is asked of the best.

    Args:
        found: the fits.

    Attributes:
        found: as given, with a `materials.fit.fit.Fit` for each law.
    """

    def __init__(self, found: Comparison) -> None:
        self.found = found

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws, the best one first."""
        return tuple(fit.form.name for fit in self.found.fits)

    def law(self, name: str) -> Fit:
        """The fit of a law: `stress`, `stress_error`, `parameters`, `covariance`, `stability`, ….

        Raises:
            KeyError: it was not fitted.
        """
        for fit in self.found.fits:
            if fit.form.name == name:
                return fit
        raise KeyError(f"{name!r}, expected one of {', '.join(self.laws)}")

    @property
    def parameters(self) -> dict[str, float]:
        """Of the best law, MPa and pure numbers."""
        return self.found.best.parameters

    @property
    def errors(self) -> dict[str, float]:
        """Standard errors of its parameters."""
        return self.found.best.errors

    @property
    def material(self) -> Material:
        """The best law with its numbers."""
        return self.found.best.material

    @functools.cached_property
    def covariance(self) -> pd.DataFrame:
        """Of the parameters of the best law."""
        import pandas as pd

        best = self.found.best
        names = [parameter.name for parameter in best.form.parameters]
        return pd.DataFrame(best.covariance, index=names, columns=names)

    @functools.cached_property
    def frame(self) -> pd.DataFrame:
        """A row for each parameter of each law."""
        import pandas as pd

        rows = [
            {
                "law": fit.form.name,
                "parameter": parameter.name,
                "value": fit.parameters[parameter.name],
                "error": fit.errors[parameter.name],
                "unit": parameter.unit,
                "settled": parameter.name not in fit.unsettled,
                "rms": fit.rms,
                "criterion": fit.criterion,
                "stable_to": fit.stability.stretch,
            }
            for fit in self.found.fits
            for parameter in fit.form.parameters
        ]
        return pd.DataFrame(rows)

    def plot(self, target: Path | str | None = None) -> Figure:
        """Tests, laws, residuals, and modes that were not measured.

        Args:
            target: PNG file that is written; none by default.
        """
        from fiberbend.drawing.page import save
        from fiberbend.fit.picture import draw

        figure = draw(self.found)
        if target is not None:
            save(figure, Path(target))
        return figure

    def save(self, target: Path | str, density: str = "") -> None:
        """Write the best law as a material file, which a case can name.

        Args:
            target: file; one that is there is replaced.
            density: such as "1.07 g/cm^3".

        Raises:
            CaseError: no density.
        """
        from fiberbend.fit.material_file import check_density, text

        check_density("density", density)
        Path(target).write_text(text(self.found, self.found.best, density), encoding="utf-8")

    def band(
        self,
        case: AnyCase,
        part: str = "wall",
        refits: int = 0,
        *,
        law: str | None = None,
        settings: Settings = (),
        seed: int = 0,
    ) -> Band:
        """The pressure at bending angles of a case with the errors of a law.

        Args:
            case: of model section or cell; a case, a mapping, or the path of a case file.
            part: what is made of the rubber.
            refits: refits to resampled tests that are solved too.
            law: the law; the best one by default.
            settings: changes to the case.
            seed: of the refits' residuals.

        Raises:
            CaseError: the case is wrong, or cannot be solved.
        """
        from fiberbend.running import launch

        checked = as_case(case, settings)
        with TURN:
            launch.start_mpi()
            from fiberbend.fit.band import band_of

            return band_of(checked, part, self.law(law or self.laws[0]), refits, seed)

    def __str__(self) -> str:
        """What the command prints."""
        from fiberbend.fit.words import lines

        return "\n".join(lines(self.found))

    def _repr_html_(self) -> str:
        """The table of laws, and that of the modes."""
        from fiberbend.fit.words import HEADS, modes, remarks_of, summary

        heads, rows = modes(self.found)
        return blocks.block(
            f"{len(self.laws)} laws fitted to {', '.join(self.found.measured)} tests",
            *(blocks.words(read.said) for read in self.found.reads),
            blocks.table(HEADS, [summary(fit, self.found) for fit in self.found.fits]),
            *(blocks.warning(text) for text in remarks_of(self.found)),
            blocks.words("Stress in kPa at the stretch in brackets; * mode not fitted"),
            blocks.table(heads, rows),
        )


def fit(
    uniaxial: Files = (),
    law: Sequence[str] | str = (),
    *,
    pure_shear: Files = (),
    equibiaxial: Files = (),
    stretch: str = "",
    strain: str = "",
    stress: str = "",
    meant: Literal["engineering", "true"] | None = None,
    gauge: str = "",
    area: tuple[str, str] | None = None,
    cycle: int = 1,
    since: str = "",
    upto: str = "",
    decimal: Literal[".", ","] | None = None,
    weights: Literal["plain", "relative"] = "plain",
    stable: bool = True,
    only: Sequence[ModeName] | ModeName = (),
) -> Fitted:
    """Fit laws of rubber to tests; as the command `fiberbend fit`, but nothing is written.

    Args:
        uniaxial: files of uniaxial tests, or names of tests that come with the program.
        law: names of laws, with all their terms or with a number of them such as "yeoh-2"; the
            usual ones by default.
        pure_shear: files of tests in pure shear.
        equibiaxial: files of equibiaxial tests.
        stretch: column of stretches, by name or number.
        strain: column of strains, or of displacements with `gauge`.
        stress: column of stresses, or of forces with `area`.
        meant: what strains and stresses are whose names do not say it.
        gauge: length at rest of what is pulled, such as "33 mm".
        area: width and thickness at rest, such as ("6 mm", "3 mm").
        cycle: which loading, from 1 on; 0: all rows.
        since: least stretch, such as "stretch 1".
        upto: greatest stretch, such as "strain 50 %".
        decimal: mark before decimals; found by default.
        weights: points of a mode count alike, or by one over their stress.
        stable: ask that the law is stable up to the greatest stretch.
        only: modes that are fitted, and the others compared; all by default.

    Raises:
        CaseError: a file, a law or an option is wrong.
    """
    only = [only] if isinstance(only, str) else only
    _known("meant", [] if meant is None else [meant], get_args(Meant))
    _known("weights", [weights], ("plain", "relative"))
    _known("decimal", [] if decimal is None else [decimal], (".", ","))
    _known("only", only, get_args(ModeName))
    modes: tuple[tuple[ModeName, Files], ...] = (
        ("uniaxial", uniaxial),
        ("pure-shear", pure_shear),
        ("equibiaxial", equibiaxial),
    )
    try:
        wanted = Wanted(
            stretch=stretch,
            strain=strain,
            stress=stress,
            meant=meant,
            gauge=_length(gauge) if gauge else None,
            area=_area(area) if area else None,
            cycle=cycle,
            least=limit(since) if since else None,
            most=limit(upto) if upto else None,
            decimal=decimal,
        )
    except ValueError as error:
        raise CaseError([Problem("fit", str(error))]) from None
    files = tuple((mode, Path(path)) for mode, given in modes for path in _several(given))
    laws = law_names([law] if isinstance(law, str) else law)
    return Fitted(compared(Asked(files, laws, wanted, weights, stable, tuple(only))))


def _known(name: str, given: Sequence[str], known: Sequence[str]) -> None:
    """Refuse words that an argument does not know; a type alone refuses nothing.

    Raises:
        CaseError: one of them.
    """
    for word in given:
        if word not in known:
            text = f"{word!r}, expected one of {', '.join(map(repr, known))}"
            raise CaseError([Problem(name, text)])


def _length(text: str) -> float:
    """A length above zero, mm."""
    value = parse(text, "length")
    if not value > 0:
        raise ValueError(f'"{text}", expected a length above zero')
    return value


def _area(sides: tuple[str, str]) -> float:
    """The cross-section, mm²."""
    if isinstance(sides, str) or len(sides) != 2:
        raise ValueError(f'area {sides!r}, expected width and thickness such as ("6 mm", "3 mm")')
    return _length(sides[0]) * _length(sides[1])


def _several(files: Files) -> Sequence[Path | str]:
    return [files] if isinstance(files, (str, Path)) else files

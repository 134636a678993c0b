"""What an entry of the table of named materials says. Without a source there is no entry."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Literal

from materials.fiber import Fiber
from materials.laws.table import LAWS
from materials.material import Material

Kind = Literal["rubber", "thread", "fabric", "paper"]
Way = Literal["uniaxial", "pure-shear", "equibiaxial"]
"""To load a specimen; the keys of `materials.fit.modes.MODES`."""
DATA = Path(__file__).resolve().parent.parent / "data"
"""Tests that come with the program."""


@dataclasses.dataclass(frozen=True)
class Source:
    """Where numbers come from.

    Attributes:
        text: who measured or published them.
        address: a DOI such as "10.1109/TRO.2015.2428504", or a URL.
        licence: under which the numbers, or the tests that they are fitted to, may be used.

    Raises:
        ValueError: one of them is missing, or the address is neither DOI nor URL.
    """

    text: str
    address: str
    licence: str

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):
            if not getattr(self, field.name).strip():
                raise ValueError(f"a source without {field.name}, expected one")
        if not self.address.startswith(("10.", "https://", "http://")):
            raise ValueError(f"{self.address!r}, expected a DOI or a URL")

    def __str__(self) -> str:
        shown = f"DOI {self.address}" if self.address.startswith("10.") else self.address
        return f"{self.text}, {shown}"


@dataclasses.dataclass(frozen=True)
class Fitted:
    """Which tests coefficients are fitted to, so that they can be fitted again.

    Attributes:
        tests: how the specimen was loaded, and the file, of every test.
        law: a law, or a law with the number of its terms, "yeoh-2".
        upto: greatest stretch that the fit sees.
        rms: root mean square of what it misses, over the greatest stress.
    """

    tests: tuple[tuple[Way, str], ...]
    law: str
    upto: float
    rms: float

    @property
    def shipped(self) -> tuple[tuple[Way, Path], ...] | None:
        """Way and path of every test that comes with the program; None where one does not."""
        paths = [(way, DATA / file.lower().replace(" ", "-")) for way, file in self.tests]
        return tuple(paths) if all(path.exists() for _, path in paths) else None


@dataclasses.dataclass(frozen=True, kw_only=True)
class Entry:
    """What every named material has.

    Attributes:
        name: in a case.
        product: what it is, and who makes it; entries of one product are one material, measured
            more than once.
        source: of its numbers.
        tested: how it was tested, in words.
        density: kg/m³, or None where nobody gives it.
        density_source: who gives it.
        note: what else a user should know; may be empty.

    Raises:
        ValueError: a name that is none, no words on the tests, or a density without its source.
    """

    name: str
    product: str
    source: Source
    tested: str
    density: float | None = None
    density_source: str = ""
    note: str = ""

    def __post_init__(self) -> None:
        if not self.name or self.name != self.name.lower() or not self.name[0].isalnum():
            raise ValueError(f"name {self.name!r}, expected small letters, digits and hyphens")
        if self.name.endswith((".yaml", ".yml")) or set(self.name) & set(" ./\\:"):
            raise ValueError(f"name {self.name!r}, expected one that is no file's")
        for field in ("product", "tested"):
            if not getattr(self, field):
                raise ValueError(f"{self.name} without {field}, expected some words")
        if (self.density is None) == bool(self.density_source):
            raise ValueError(f"{self.name}: expected a density and its source, or none of them")

    @property
    def kind(self) -> Kind:
        """What it is used for."""
        raise NotImplementedError

    @property
    def stiffness(self) -> float:
        """Young's modulus at rest, MPa."""
        raise NotImplementedError

    @property
    def licence(self) -> str:
        """Of the numbers, or of the tests that they are fitted to."""
        return self.source.licence

    @property
    def says(self) -> str:
        """The source of everything, in one line."""
        text = str(self.source)
        return f"{text}; density: {self.density_source}" if self.density_source else text


@dataclasses.dataclass(frozen=True, kw_only=True)
class Rubber(Entry):
    """A rubber: a law with its coefficients.

    Attributes:
        law: name of the law.
        coefficients: of the law, in its units.
        stretches: least and greatest stretch of the tests, as far as the coefficients were fitted
            to them; None where the source does not say.
        fitted: to which tests, where that was done here.
    """

    law: str
    coefficients: dict[str, float]
    stretches: tuple[float, float] | None
    fitted: Fitted | None = None

    @property
    def kind(self) -> Kind:
        """A rubber."""
        return "rubber"

    @property
    def material(self) -> Material:
        """As the program takes it.

        Raises:
            ValueError: a law, coefficients or stretches that nobody could use; a test asks every
                entry, for at every start it would take a hundredth of a second.
        """
        return Material(
            self.law, self.coefficients, self.density, source=self.says, tested=self.stretches
        )

    @property
    def stiffness(self) -> float:
        """Three times the shear modulus: it keeps its volume."""
        return 3 * self.material.initial_shear_modulus

    @property
    def units(self) -> dict[str, str]:
        """What stands behind each number, " MPa" or nothing."""
        parameters = LAWS[self.law].parameters
        return {p.name: "" if p.unit == "1" else f" {p.unit}" for p in parameters}


@dataclasses.dataclass(frozen=True, kw_only=True)
class Thread(Entry):
    """A thread of a winding.

    Attributes:
        modulus: Young's modulus, MPa, of its cross-section, which is round and full.
        diameter: mm; None where it is made in many, so that a case gives it.
        radius_factor: part of the radius that carries.
    """

    modulus: float
    diameter: float | None = None
    radius_factor: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        self.fiber(self.diameter or 1.0)

    @property
    def kind(self) -> Kind:
        """A thread."""
        return "thread"

    @property
    def stiffness(self) -> float:
        """That of what carries."""
        return self.modulus

    def fiber(self, diameter: float | None = None) -> Fiber:
        """As the program takes it.

        Args:
            diameter: mm, where it has none of its own.

        Raises:
            ValueError: two diameters, or none.
        """
        one = self.diameter if diameter is None else diameter
        if one is None:
            raise ValueError(f"{self.name} has no diameter of its own, expected one")
        return Fiber(self.modulus, one, self.radius_factor, self.says)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Sheet(Entry):
    """A fabric or a paper, of a strip or a layer.

    Attributes:
        sort: fabric or paper.
        modulus: Young's modulus along it, MPa, of its whole thickness.
        thickness: mm; None where it is made in many, so that a case gives it.
    """

    sort: Literal["fabric", "paper"]
    modulus: float
    thickness: float | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        for value in (self.modulus, 1.0 if self.thickness is None else self.thickness):
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"{self.name}: {value}, expected a positive number")

    @property
    def kind(self) -> Kind:
        """Fabric or paper."""
        return self.sort

    @property
    def stiffness(self) -> float:
        """Along it."""
        return self.modulus

    @property
    def material(self) -> Material:
        """As a layer: a solid of its Young's modulus that keeps its volume."""
        return Material("neo-hooke", {"mu": self.modulus / 3}, self.density, source=self.says)

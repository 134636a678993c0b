"""The programs to which a rod is handed over: which files each gets, and what it needs."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from importlib.resources import files
from typing import Any

from fiberbend.export import mjcf
from fiberbend.schema.problems import CaseError, Problem

DATA = "rod.json"
COUPLING = 0.1
"""Greatest square of a coupling that may be left out, in parts of both stiffnesses."""


@dataclasses.dataclass(frozen=True)
class Target:
    """A program.

    Attributes:
        about: what it gets, in a few words.
        moves: it needs masses.
        diagonal: it has no coupling of bending with side bending or twist.
        scripts: files that come as they are.
        made: files that are made of the record and of gravity in m/s², by their names.
        tested: whether what it gets was run in the program by the tests.
    """

    about: str
    moves: bool = True
    diagonal: bool = False
    scripts: tuple[str, ...] = ()
    made: tuple[tuple[str, Callable[[dict[str, Any]], str]], ...] = ()
    tested: bool = True

    @property
    def names(self) -> tuple[str, ...]:
        """Of all its files."""
        return (DATA, *self.scripts, *(name for name, _ in self.made))

    def contents(self, record: dict[str, Any]) -> dict[str, str]:
        """What its files say beside that of the record.

        Raises:
            CaseError: it needs what the record does not have.
        """
        self._check(record)
        found = {name: _script(name) for name in self.scripts}
        return found | {name: make(record) for name, make in self.made}

    def _check(self, record: dict[str, Any]) -> None:
        mass, axis = record["mass"], record["axis"]
        if self.moves and not mass["known"]:
            raise CaseError([Problem("mass", mass["missing"])])
        if self.moves:
            self._refuse(axis, "coupling_of_stretch_and_twist", "stretch and twist")
        if self.diagonal:
            self._refuse(axis, "coupling_of_bending", "bending, side bending and twist")

    def _refuse(self, axis: dict[str, Any], name: str, what: str) -> None:
        if axis[name] > COUPLING:
            text = (
                f"{what} are coupled by {axis[name]:.2g} of both stiffnesses, expected less than "
                f"{COUPLING:g}: {self.about} has no such coupling; --to json has it"
            )
            raise CaseError([Problem(f"axis.{name}", text)])


def _script(name: str) -> str:
    return (files("fiberbend.export") / "scripts" / name).read_text(encoding="utf-8")


TARGETS = {
    "pyelastica": Target("a Cosserat rod of PyElastica", scripts=("rod_pyelastica.py",)),
    "mujoco": Target(
        "a chain of joints in MuJoCo",
        diagonal=True,
        scripts=("rod_mujoco.py",),
        made=(("rod.xml", mjcf.text),),
    ),
    "sofa": Target(
        "a scene of SOFA's plugin Cosserat",
        diagonal=True,
        scripts=("rod_sofa.py",),
        tested=False,
    ),
    "json": Target("a file", moves=False, tested=False),
}
"""By the names that the command takes."""

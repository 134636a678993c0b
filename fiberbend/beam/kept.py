"""The flexibility of an actuator's section and of its caps, made once and kept."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import json
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np

from fiberbend.beam.flexibility import Threads, flexibility
from fiberbend.beam.form import shear_form
from fiberbend.beam.stressed import shear_stiffness
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.section_beside import as_section
from fiberbend.case.symmetry import wound
from fiberbend.effects.pressure import inflate
from fiberbend.process.kept import Kept
from fiberbend.sectionlaw.store import digest_of
from geometry.bodies.quads import section_mesh
from geometry.mesh.centroid import winding_weights
from geometry.sections.size import MeshSize
from geometry.sections.table import section_layout
from geometry.winding.segments import EmbeddedFibers
from rod.functions import Floats
from rod.law import Law
from rod.layout import AT_REST, STRAINS
from rod.sheared import Sheared

_LENGTH = 4.0
"""Of a chamber in half widths, whatever its own: nothing hangs on it."""
STATES = 3
"""Pressures, of equal distances, through which and zero the stiffness is a polynomial."""
_ALIKE = 1e-3
"""Part by which a section may shear otherwise to the side and still be alike in all directions."""
_FINE = 1
"""Elements through each part: two move the baseline's shear stiffness by 0.6 %."""


@runtime_checkable
class Threaded(Protocol):
    """A term of threads on the outline."""

    segments: EmbeddedFibers
    stiffness: float | Floats


@dataclasses.dataclass(frozen=True)
class Beam:
    """Strains by forces at rest, about the line of centroids, in the order of `rod.layout.STRAINS`.

    Attributes:
        chamber: of the section between the caps, its winding spread, (6, 6); 1/N, 1/(N mm) and
            1/(N mm²).
        cap: of a solid cap, (6, 6).
        stiffening: what is added to the stiffness against shear in the plane of bending by power
            of P in MPa from the first on, (d,), N; nothing of a section that has no such plane.
    """

    chamber: Floats
    cap: Floats
    stiffening: Floats

    @property
    def alike(self) -> bool:
        """Whether it shears alike in all directions."""
        own = self.chamber
        return bool(abs(own[0, 0] - own[1, 1]) < _ALIKE * own[1, 1])

    @property
    def centre(self) -> float:
        """y of the chamber's centre of shear from the line of centroids, mm."""
        return float(self.chamber[0, 5] / self.chamber[5, 5])

    @property
    def cap_stiffness(self) -> Floats:
        """Of a cap against shear along x and y, at rest, (2,), N."""
        return np.diagonal(shear_form(self.cap, STRAINS))[:2].copy()

    def stiffness(self, pressure: float) -> Floats:
        """Of the chamber against shear along x and y, (2,), N.

        Args:
            pressure: MPa.
        """
        out = np.diagonal(shear_form(self.chamber, STRAINS))[:2].copy()
        powers = pressure ** (1.0 + np.arange(len(self.stiffening)))
        out[0 if self.alike else 1 :] += float(powers @ self.stiffening)
        return out

    def beside(self, law: Law, strains: tuple[str, ...]) -> Sheared:
        """The law of the chamber with shear.

        Args:
            law: of the other strains.
            strains: of the rod, shears among them.
        """
        return self._sheared(law, strains, self.chamber, 1.0)

    def beside_cap(self, law: Law, strains: tuple[str, ...]) -> Sheared:
        """The law of a cap with shear; the pressure that it closes in stiffens it in proportion.

        Args:
            law: of the other strains.
            strains: of the rod, shears among them.
        """
        part = float(self.chamber[1, 1] / self.cap[1, 1])
        return self._sheared(law, strains, self.cap, part)

    def _sheared(
        self, law: Law, strains: tuple[str, ...], flexible: Floats, part: float
    ) -> Sheared:
        form = shear_form(flexible, strains)
        across = STRAINS[:2] if self.alike else STRAINS[1:2]
        forms = np.zeros((1 + len(self.stiffening), *form.shape))
        forms[0] = form
        for name in across:
            if name in strains:
                place = strains.index(name)
                forms[1:, place, place] = part * self.stiffening
        return Sheared(
            law,
            tuple(place for place, name in enumerate(strains) if name not in STRAINS[:2]),
            forms,
            AT_REST[[STRAINS.index(name) for name in strains]],
        )

    def packed(self) -> bytes:
        """As a JSON file."""
        content = {name: value.tolist() for name, value in dataclasses.asdict(self).items()}
        return json.dumps(content).encode()


def unpacked(content: bytes) -> Beam:
    """A beam from a JSON file.

    Raises:
        ValueError: it holds none.
    """
    try:
        known = json.loads(content)
        parts = {field.name: known[field.name] for field in dataclasses.fields(Beam)}
        beam = Beam(**{name: np.array(value, dtype=float) for name, value in parts.items()})
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"no beam: {error}") from None
    for each in (beam.chamber, beam.cap):
        if each.shape != (6, 6) or not np.isfinite(each).all() or np.linalg.eigvalsh(each)[0] <= 0:
            raise ValueError("no beam: flexibilities of six strains expected")
    if beam.stiffening.shape != (STATES,) or not np.isfinite(beam.stiffening).all():
        raise ValueError(f"no beam: {STATES} numbers by the pressure expected")
    return beam


def kept(path: Path | None = None) -> Kept:
    """Beams that were made before, in the user's own cache or in another folder."""
    return Kept("beams", "flexibilities of sections", ".json", path)


def beam_of(case: Case, greatest: float, store: Kept | None = None) -> Beam:
    """Section and cap of an actuator as beams, from the store or anew.

    Args:
        case: a checked case without zones.
        greatest: pressure up to which, MPa.
        store: where they are kept; that of the user unless given.

    Raises:
        fiberbend.schema.problems.CaseError: no section stands beside the case, or it has no state
            under one of the pressures.
    """
    width = convert.dimensions(case.actuator).outline_half_width
    beside = as_section(case, inflate(to=greatest))
    actuator = case.actuator.model_copy(update={"length": _LENGTH * width})
    section = beside.model_copy(update={"actuator": actuator})
    store = kept() if store is None else store
    own = digest_of(section, ("beam", _code()), greatest, None, (0.0, 0.0))
    with store.alone(own):
        known = store.read(own, unpacked)
        if known is None:
            known = _solved(section, greatest)
            store.write(own, known.packed())
    return known


def _solved(section: Case, greatest: float) -> Beam:
    actuator, site = convert.dimensions(section.actuator), convert.site(section)
    layout = section_layout(actuator, MeshSize(section=_FINE, half=False))
    hollow, materials = section_mesh(layout.without_fill()), dict(site.materials)
    height = float(winding_weights(hollow)[1][1])
    threads = []
    for effect in section.effects:
        if effect.inflation() is None:
            built = effect.spread().build(site, hollow, convert.requests(section))
            terms = [term for term in built.terms if isinstance(term, Threaded)]
            threads += [Threads(term.segments, term.stiffness) for term in terms]
    known = flexibility(hollow, height, materials, threads)
    cap = flexibility(section_mesh(layout), height, materials)
    if not wound(section).plane:
        return Beam(known, cap, np.zeros(STATES))
    pressures = greatest * (1.0 + np.arange(STATES)) / STATES
    rest, *stressed = shear_stiffness(section, pressures.tolist())
    powers = pressures[:, None] ** (1.0 + np.arange(STATES))
    return Beam(known, cap, np.linalg.solve(powers, np.array(stressed) - rest))


@functools.cache
def _code() -> str:
    found = hashlib.sha256()
    for file in sorted(Path(__file__).resolve().parent.glob("*.py")):
        found.update(file.read_bytes())
    return found.hexdigest()

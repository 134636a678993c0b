"""The flexibility of an actuator's section and of its caps, made once and kept."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np

from fiberbend.beam.flexibility import Threads, flexibility
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.section_beside import as_section
from fiberbend.effects.pressure import inflate
from fiberbend.process.kept import Kept
from fiberbend.sectionlaw.store import digest_of
from geometry.bodies.quads import section_mesh
from geometry.mesh.centroid import winding_weights
from geometry.sections.size import MeshSize
from geometry.sections.table import section_layout
from geometry.winding.segments import EmbeddedFibers
from rod.functions import Floats
from rod.layout import STRAINS

_LENGTH = 4.0
"""Of a chamber in half widths, whatever its own: nothing hangs on it."""
_PRESSURE = 1e-3
_FINE = 1
"""Elements through each part: two move the baseline's shear stiffness by 0.6 %."""


@runtime_checkable
class Threaded(Protocol):
    """A term of threads on the outline."""

    segments: EmbeddedFibers
    stiffness: float | Floats


def shear_form(flexibility: Floats, strains: Sequence[str]) -> Floats:
    """Q of `rod.sheared.Sheared`: what shear costs beside the other strains, (m, m).

    Of all energy σ·F σ/2 it is the part that a law of the other strains ε at V = 0 has not:
    ½ (γ − B ε)·C (γ − B ε), B = F_γε F_εε⁻¹ and C = (F_γγ − B F_εγ)⁻¹.

    Args:
        flexibility: F of a section, (6, 6).
        strains: of the rod, out of `rod.layout.STRAINS`.
    """
    free = [name for name in STRAINS[:2] if name in strains]
    others = [name for name in strains if name not in free]
    first, second = ([STRAINS.index(name) for name in names] for names in (free, others))
    mixed = flexibility[np.ix_(first, second)]
    carried = np.linalg.solve(flexibility[np.ix_(second, second)], mixed.T).T
    stiffness = np.linalg.inv(flexibility[np.ix_(first, first)] - carried @ mixed.T)
    turn = np.zeros((len(free), len(strains)))
    turn[:, [strains.index(name) for name in free]] = np.eye(len(free))
    turn[:, [strains.index(name) for name in others]] = -carried
    out: Floats = turn.T @ stiffness @ turn
    return (out + out.T) / 2


@dataclasses.dataclass(frozen=True)
class Beam:
    """Strains by forces at rest, about the line of centroids, in the order of `rod.layout.STRAINS`.

    Attributes:
        chamber: of the section between the caps, its winding spread, (6, 6); 1/N, 1/(N mm) and
            1/(N mm²).
        cap: of a solid cap, (6, 6).
    """

    chamber: Floats
    cap: Floats

    def packed(self) -> bytes:
        """As a JSON file."""
        return json.dumps({"chamber": self.chamber.tolist(), "cap": self.cap.tolist()}).encode()


def unpacked(content: bytes) -> Beam:
    """A beam from a JSON file.

    Raises:
        ValueError: it holds none.
    """
    try:
        known = json.loads(content)
        beam = Beam(np.array(known["chamber"], dtype=float), np.array(known["cap"], dtype=float))
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"no beam: {error}") from None
    for each in (beam.chamber, beam.cap):
        if each.shape != (6, 6) or not np.isfinite(each).all() or np.linalg.eigvalsh(each)[0] <= 0:
            raise ValueError("no beam: flexibilities of six strains expected")
    return beam


def kept(path: Path | None = None) -> Kept:
    """Beams that were made before, in the user's own cache or in another folder."""
    return Kept("beams", "flexibilities of sections", ".json", path)


def beam_of(case: Case, store: Kept | None = None) -> Beam:
    """Section and cap of an actuator as beams, from the store or anew.

    Args:
        case: a checked case without zones.
        store: where they are kept; that of the user unless given.

    Raises:
        fiberbend.schema.problems.CaseError: no section stands beside the case.
    """
    width = convert.dimensions(case.actuator).outline_half_width
    beside = as_section(case, inflate(to=_PRESSURE))
    actuator = case.actuator.model_copy(update={"length": _LENGTH * width})
    section = beside.model_copy(update={"actuator": actuator})
    store = kept() if store is None else store
    own = digest_of(section, ("beam", _code()), 0.0, None, (0.0, 0.0))
    with store.alone(own):
        known = store.read(own, unpacked)
        if known is None:
            known = _solved(section)
            store.write(own, known.packed())
    return known


def _solved(section: Case) -> Beam:
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
    return Beam(
        flexibility(hollow, height, materials, threads),
        flexibility(section_mesh(layout), height, materials),
    )


@functools.cache
def _code() -> str:
    found = hashlib.sha256()
    for file in sorted(Path(__file__).resolve().parent.glob("*.py")):
        found.update(file.read_bytes())
    return found.hexdigest()

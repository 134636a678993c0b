"""What a rod is at rest: pieces along its axis, the strains that are free, and its clamped root."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np

from rod.functions import Floats

STRAINS = ("shear_x", "shear_y", "stretch", "curvature", "side_curvature", "twist")
"""γ_x, γ_y, λ in 1; k_x, k_y, τ in rad a mm of z at rest: the components of the screw of a piece in
the section's own axes (x lateral, y up, z along the axis). k_x > 0 bends toward −y, k_y > 0 toward
x."""
AT_REST = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])


@dataclasses.dataclass(frozen=True)
class Layout:
    """Pieces of a rod from root to tip, and which of its strains are unknowns.

    Attributes:
        lengths: h of the pieces at rest, (n,), mm.
        strains: names out of STRAINS in their order; the others stay at rest. Without shear the
            rod is Kirchhoff's with a stretch, with it Simo's and Reissner's.
        rotation: axes of the clamped root as columns, (3, 3).
        place: of the root, (3,), mm.

    Raises:
        ValueError: lengths that are not positive, unknown or unordered strains, no rotation.
    """

    lengths: Floats
    strains: tuple[str, ...] = ("stretch", "curvature")
    rotation: Floats = dataclasses.field(default_factory=lambda: np.eye(3))
    place: Floats = dataclasses.field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        lengths = np.asarray(self.lengths, dtype=float)
        if lengths.ndim != 1 or not len(lengths) or not np.all((lengths > 0) & (lengths < np.inf)):
            raise ValueError(f"lengths of pieces: positive mm expected, not {self.lengths}")
        unknown = [name for name in self.strains if name not in STRAINS]
        if unknown or not self.strains:
            raise ValueError(f"strains {self.strains}: some of {', '.join(STRAINS)} expected")
        if self.columns != sorted(set(self.columns)):
            raise ValueError(f"strains {self.strains}: each once and in the order of {STRAINS}")
        turn = np.asarray(self.rotation, dtype=float)
        square = np.allclose(turn.T @ turn, np.eye(3), rtol=0.0, atol=1e-9)
        if turn.shape != (3, 3) or not square or np.linalg.det(turn) < 0:
            raise ValueError(f"rotation of the root: a rotation expected, not {self.rotation}")
        if np.shape(self.place) != (3,) or not np.all(np.isfinite(self.place)):
            raise ValueError(f"place of the root: three mm expected, not {self.place}")

    @functools.cached_property
    def columns(self) -> list[int]:
        """Places of the free strains among the six."""
        return [STRAINS.index(name) for name in self.strains]

    @property
    def shape(self) -> tuple[int, int]:
        """Pieces and strains of each."""
        return len(self.lengths), len(self.strains)

    @property
    def plane(self) -> bool:
        """Whether it stays in the plane of y and z of its root."""
        return not {"shear_x", "side_curvature", "twist"} & set(self.strains)

    @functools.cached_property
    def turned(self) -> bool:
        """Whether the axes of the root are other ones than those of space."""
        return not np.array_equal(self.rotation, np.eye(3))

    def at_rest(self) -> Floats:
        """Strains of the straight rod, (n, m)."""
        return np.tile(AT_REST[list(self.columns)], (len(self.lengths), 1))

    def full(self, strains: Floats) -> Floats:
        """All six strains of each piece, (n, 6), by the free ones, (n, m)."""
        out = np.empty((len(self.lengths), len(STRAINS)))
        out[:] = AT_REST
        out[:, self.columns] = strains
        return out

    def weights(self, strain: str) -> Floats:
        """w with Σ w ε = ∫ ε ds, (n, m): of a curvature the angle by which the rod bends.

        Args:
            strain: name of a free strain.

        Raises:
            ValueError: it is not free.
        """
        if strain not in self.strains:
            raise ValueError(f"{strain} is no unknown of this rod, which has {self.strains}")
        out = np.zeros(self.shape)
        out[:, self.strains.index(strain)] = self.lengths
        return out

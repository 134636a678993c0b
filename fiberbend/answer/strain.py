"""Greatest strain of a state, and where it is."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from fiberbend.case import convert
from fiberbend.case.case import Case

if TYPE_CHECKING:
    from fiberbend.states.recovery import SplitNodes
    from fiberbend.states.snapshot import ModelMesh, Snapshot
    from geometry.actuator import Actuator
    from geometry.mesh.data import Floats

_NEAR_END = 0.1
"""Parts of the chamber's length that are near its root or its tip."""
_CROWN = 0.35
"""Parts of the half width up to which the upper half of a section is its crown."""
_CORNER = 0.9
"""Parts of the chamber's half width from which its lowest line is a corner."""
_ROUNDING = 1e-6
"""Millimetres by which round-off may move a line."""
_BEYOND = 0.01
"""Part of a stretch by which a run may be beyond tests unsaid: of a node's average."""
_SAME = 1e-6
"""Part of the greatest strain by which places may miss it and still be alike: the first is told."""


def greatest_strain(case: Case, model_mesh: ModelMesh, snapshot: Snapshot) -> dict[str, Any]:
    """The entry `greatest_strain` of run.json.

    Of a section or a cell it is the same all along; of a body it is that at the nodes, averaged
    within each region as pictures and fields show it.

    Args:
        case: the case.
        model_mesh: mesh of the model.
        snapshot: a state of it.

    Returns:
        Step, pressure in kPa, angle in degrees; the maximum principal strain, logarithmic ln λ1 and
        nominal λ1 − 1; its region, its place in words, and its coordinates at rest in mm. Where
        materials are strained beyond their tests, `beyond_tests` has a sentence on each.
    """
    import numpy as np

    from fiberbend.states.recovery import principal_stretches, split_nodes

    mesh = model_mesh.mesh
    copies = split_nodes(mesh)
    stretch = principal_stretches(mesh, snapshot, copies)[:, 0]
    top = float(stretch.max())
    copy = int(np.argmax(stretch >= top - _SAME * abs(top - 1)))
    cell = int(np.flatnonzero((copies.cells == copy).any(axis=1))[0])
    region = next(name for name, i in mesh.regions.items() if i == mesh.cell_region[cell])
    at = mesh.nodes[copies.node[copy]]
    # a slice that repeats has no place along the axis
    shown = at[:2] if model_mesh.uniform else at
    beyond = list(_beyond(model_mesh, copies, stretch))
    return {
        **({"beyond_tests": beyond} if beyond else {}),
        "step": snapshot.step,
        "pressure_kPa": snapshot.pressure_kpa,
        "angle_deg": snapshot.angle_deg,
        "logarithmic": float(np.log(top)),
        "nominal": top - 1,
        "region": region,
        "place": _place(convert.dimensions(case.actuator), region, [float(v) for v in shown]),
        **{f"{axis}_mm": float(v) for axis, v in zip("xyz", shown, strict=False)},
    }


def _beyond(model_mesh: ModelMesh, copies: SplitNodes, stretch: Floats) -> Iterator[str]:
    """Regions that are stretched further than the tests of their material, a sentence each."""
    mesh = model_mesh.mesh
    for region, number in mesh.regions.items():
        tested = model_mesh.materials[region].tested
        cells = copies.cells[mesh.cell_region == number]
        if tested is None or not cells.size:
            continue
        reached = float(stretch[cells].max())
        if reached > tested[1] * (1 + _BEYOND):
            yield (
                f"materials.{region}: tested to a stretch of {tested[1]:.3g}, the run reaches "
                f"{reached:.3g}; beyond its tests a law is a guess"
            )


def _place(actuator: Actuator, region: str, at: list[float]) -> str:
    """A place in words: its region, around the section, and along the axis."""
    words, profile = [region], actuator.profile
    across, height = abs(at[0]), at[1] - profile.bottom
    if height < -_ROUNDING:
        words.append("under the chamber")
    elif height <= _ROUNDING:
        corner = across >= _CORNER * profile.half_width
        words.append("lower corner of the chamber" if corner else "lower face of the chamber")
    elif abs(at[1] - profile.top) <= _ROUNDING and abs(across - profile.half_width) <= _ROUNDING:
        words.append("upper corner of the chamber")
    elif height > (profile.top - profile.bottom) / 2 and across <= _CROWN * profile.half_width:
        words.append("crown")
    else:
        words.append("side")
    if len(at) == 3:
        length, z = actuator.length, at[2]
        if z < -_ROUNDING:
            words.append("in the root cap")
        elif z > length + _ROUNDING:
            words.append("in the tip cap")
        elif z <= _NEAR_END * length:
            words.append("near the root")
        elif z >= (1 - _NEAR_END) * length:
            words.append("near the tip")
    return ", ".join(words)

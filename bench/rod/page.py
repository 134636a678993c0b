"""docs/evidence/rod.md, from the records alone."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

from bench.rod import compare
from bench.rod.compare import Difference
from bench.rod.record import Record, path_of, read
from bench.rod.scenes import COARSE, FINE, PLAIN, SCENES, SECTION, Scene
from bench.tables import table

PAGE = Path(__file__).resolve().parent.parent.parent / "docs" / "evidence" / "rod.md"
ROD, BODY = "rod", "body"
ANGLE_BAND = 0.015
TOUCH_BAND = 0.02
UNIFORM_BAND = 1e-3

HEAD = """# The rod beside the body

Written by `python -m bench.rod page` from the records in bench/rod/records, which `python -m
bench.rod solve --model rod` makes, and `--model body` with `--mesh coarse` and `--mesh fine`. The
case of the rod differs from that of the coarse body by its line `model` and nothing else;
bench/rod/scenes.py has them.

Every kept state is compared at equal loads: the greatest difference along the history, and that at
its end. An angle is in parts of the greatest of its history, a tip in mm, all of it in space.
'Fine' is the body on a finer mesh beside the coarse one: how far the reference is off by itself.
'Beside fine' is the rod beside that. Seconds are of one processor, the rod's with its tables in the
cache; what making them took is in the last table.
"""
LOADS = """## Loads

The baseline with a chamber of 120 mm up to 60 kPa, the loads put on before the pressure unless the
scene says; elements of 8 mm, fine 4 mm and two through each part. Asked for: angle within 1.5 %,
tip within 1.5 mm, of free bending 1 mm. The angle is the turn of the scene's motion: under the
force along x to the side, of the tube its twist. The tube has elements of 4 mm, fine 2 mm; of what
twists by itself a tip within 3 mm is asked for, and no angle.
"""
UNIFORM = """## Uniform part

The angle of the middle half beside that of `model: section` by itself at the same pressure, in
parts of itself, greatest of all states; 0.1 % is asked for. The section has two elements through
each part as the law of the rod does, the body one.
"""
TOUCH = """## Obstacles

cases/grasp.yaml, cases/grasp_table.yaml, cases/blocked_contact.yaml and, its winding spread,
cases/blocked_tip.yaml. Touch within 2 %, force within 6 %, of a blocked tip 10 %, in parts of the
greatest force of the history, are asked for.
"""
COSTS = """## What it costs

Seconds of one processor of the whole call, from the case to the last row; unknowns; iterations of
Newton's method. 'First' is the call that makes the tables.
"""


SHEAR = """## What shear does

The same rods without shear, as they were before it (records `plain`, of the commit that each of
them names), beside the finer body where there is one. Forces are those of post and roof, in parts
of the body's greatest.

"""
LEFT = """## What is left, and why

- All angles are some tenths of a percent above the coarse body's: its elements of 8 mm miss 0.3° of
  what a pressure turns at the ends of the chamber, which the rod has by elements of 4 mm.
- The touch of the bar: the floor of a section moves 0.3 mm away from its line at 20 kPa, which is
  what the bar is nearer to the body; the outline of the rod is that at rest.
- Under 0.2 N along x: 0.1° of 1.4° to the side; how pressure stiffens a section against shear to
  the side is not computed.
- Between roof and post: angles, a tenth too great. Sections of a rod keep their shape where roof
  and post press on them, and shear changes there within a width of the section, for which a beam
  is no theory.
- That a cap stiffens against shear under pressure as the chamber does is assumed, not computed:
  without it the tip force is 10 and 17 % too small at 200 kPa ([On a rod](../contact.md#on-a-rod)).
"""


def page(scenes: tuple[Scene, ...] = SCENES) -> str:
    """The page."""
    found = [each for each in map(_Found, scenes) if each.complete]
    loaded = [_load_row(each) for each in found if not each.scene.obstacle]
    parts = [HEAD, LOADS, "\n".join(table(_LOAD_HEAD, loaded))]
    uniform = [row for each in found for row in _uniform_rows(each)]
    parts += [UNIFORM, "\n".join(table(["scene", "rod", "kept", "body"], uniform))]
    touching = [_touch_row(each) for each in found if each.scene.obstacle]
    parts += [TOUCH, "\n".join(table(_TOUCH_HEAD, touching))]
    parts += [SHEAR, "\n".join(table(_SHEAR_HEAD, list(map(_shear_row, _sheared(found)))))]
    parts += [COSTS, "\n".join(table(_COST_HEAD, [_cost_row(each) for each in found]))]
    parts += [LEFT, "\n".join([*_ends(found), *_refused(scenes)])]
    return "\n".join(part.rstrip() + "\n" for part in parts if part.strip())


class _Found:
    """The records of a scene.

    Attributes:
        scene: the scene.
        rod: of the rod.
        coarse: of the body.
        fine: of the finer body; None where it is not recorded.
        section: of its section by itself, likewise.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        paths = [path_of(scene.name, *which) for which in ((ROD, COARSE), (BODY, COARSE))]
        self.complete = all(path.exists() for path in paths)
        fine, section = path_of(scene.name, BODY, FINE), path_of(scene.name, SECTION, COARSE)
        self.fine: Record | None = read(fine) if fine.exists() else None
        self.section: Record | None = read(section) if section.exists() else None
        if self.complete:
            self.rod, self.coarse = (read(path) for path in paths)


_LOAD_HEAD = [
    *("scene", "angle", "greatest off", "last off", "tip off", "last", "kept"),
    *("fine: angle", "fine: tip", "beside fine: angle", "tip"),
]


def _load_row(each: _Found) -> list[str]:
    scene = each.scene
    angle = compare.difference(each.coarse, each.rod, scene.angle)
    tip = compare.tips(each.coarse, each.rod)
    turns = angle is not None and angle.scale > _TURNS
    kept = tip.greatest <= scene.band
    asked = turns and scene.band < _OF_TWISTING
    kept = kept and (not asked or angle is None or angle.share <= ANGLE_BAND)
    row = [scene.title, *_angle(angle), *_millimetres(tip), _word(kept)]
    if each.fine is None:
        return [*row, "", "", "", ""]
    own = compare.difference(each.coarse, each.fine, scene.angle)
    own_tip = compare.tips(each.coarse, each.fine)
    beside = compare.difference(each.fine, each.rod, scene.angle)
    beside_tip = compare.tips(each.fine, each.rod)
    return [
        *row,
        _angle(own)[1],
        _millimetres(own_tip)[0],
        _angle(beside)[1],
        _millimetres(beside_tip)[0],
    ]


_OF_TWISTING = 3.0
"""Band of the tip, mm, of scenes of which no angle is asked for."""
_TURNS = 0.5
"""Angle in degrees below which none is compared."""


def _angle(found: Difference | None) -> list[str]:
    if found is None or found.scale < _TURNS or math.isnan(found.scale):
        return ["", "", ""]
    return [f"{found.scale:.2f}°", f"{found.share:.2%}", f"{found.last_share:+.2%}"]


def _millimetres(found: Difference) -> list[str]:
    return [f"{found.greatest:.2f} mm", f"{found.last:.2f} mm"]


def _word(kept: bool) -> str:
    return "yes" if kept else "**no**"


def _uniform_rows(each: _Found) -> Iterator[list[str]]:
    """Of scenes of which the section is recorded."""
    if each.section is None:
        return
    rod, body = (_off_section(each.section, record) for record in (each.rod, each.coarse))
    yield [each.scene.title, f"{rod:.3%}", _word(rod <= UNIFORM_BAND), f"{body:.3%}"]


def _off_section(section: Record, record: Record) -> float:
    """Greatest difference of the angle of the middle half, in parts of itself, where both are."""
    own = dict(zip(section.column(compare.PRESSURE), section.column("angle_deg"), strict=True))
    middle = zip(record.column(compare.PRESSURE), record.column("uniform_angle_deg"), strict=True)
    parts = [
        abs(angle / own[pressure] - 1)
        for pressure, angle in middle
        if pressure in own and own[pressure] > _TURNS
    ]
    return max(parts)


_TOUCH_HEAD = [
    *("scene", "touch of the body", "of the rod", "off", "greatest force", "off", "last off"),
    *("kept", "fine: touch", "fine: force"),
]


def _touch_row(each: _Found) -> list[str]:
    scene = each.scene
    own, other = (compare.touch(record, scene.obstacle) for record in (each.coarse, each.rod))
    force = compare.forces(each.coarse, each.rod, scene.obstacle)
    off = other / own - 1
    kept = force is not None and force.share <= scene.force_band
    kept = kept and (math.isnan(own) or abs(off) <= TOUCH_BAND)
    row = [scene.title, *(["", "", ""] if math.isnan(own) else _touch(own, other, off))]
    row += ["", "", ""] if force is None else _force(force)
    row += [_word(kept)]
    if each.fine is None:
        return [*row, "", ""]
    fine = compare.touch(each.fine, scene.obstacle)
    finer = compare.forces(each.coarse, each.fine, scene.obstacle)
    row += ["" if math.isnan(own) else f"{fine / own - 1:+.2%}"]
    return [*row, "" if finer is None else f"{finer.share:.2%}"]


def _touch(own: float, other: float, off: float) -> list[str]:
    return [f"{own:.2f} kPa", f"{other:.2f} kPa", f"{off:+.2%}"]


def _force(found: Difference) -> list[str]:
    return [f"{found.scale:.3f} N", f"{found.share:.2%}", f"{found.last_share:+.2%}"]


_SHEAR_HEAD = [
    *("scene", "angle off without", "with", "tip off without", "with"),
    *("force off without", "with", "roof off without", "with"),
]
_ROOF = "roof_force_N"


def _sheared(found: list[_Found]) -> Iterator[tuple[_Found, Record]]:
    """Scenes whose rod is recorded without shear too."""
    for each in found:
        path = path_of(each.scene.name, ROD, PLAIN)
        if path.exists():
            yield each, read(path)


def _shear_row(both: tuple[_Found, Record]) -> list[str]:
    each, plain = both
    body = each.fine or each.coarse
    rods, row = (plain, each.rod), [each.scene.title]
    row += [_angle(compare.difference(body, rod, each.scene.angle))[1] for rod in rods]
    row += [_millimetres(compare.tips(body, rod))[0] for rod in rods]
    force = each.scene.obstacle
    row += [_share(compare.forces(body, rod, force)) if force else "" for rod in rods]
    return row + [_share(compare.difference(body, rod, _ROOF)) for rod in rods]


def _share(found: Difference | None) -> str:
    return "" if found is None else f"{found.share:.1%}"


_COST_HEAD = [
    *("scene", "body, s", "unknowns", "iterations", "fine body, s"),
    *("rod, s", "unknowns", "iterations", "first, s", "body over rod"),
]


def _cost_row(each: _Found) -> list[str]:
    body, rod = each.coarse, each.rod
    fine = "" if each.fine is None else f"{each.fine.cpu_s:.1f}"
    return [
        each.scene.title,
        f"{body.cpu_s:.1f}",
        f"{body.unknowns}",
        f"{body.iterations}",
        fine,
        f"{rod.cpu_s:.2f}",
        f"{rod.unknowns}",
        f"{rod.iterations}",
        "" if rod.first_cpu_s is None else f"{rod.first_cpu_s:.1f}",
        f"{body.cpu_s / rod.cpu_s:.0f}",
    ]


def _ends(found: list[_Found]) -> Iterator[str]:
    """How runs ended that did not come to their end."""
    for each in found:
        for name, record in (("rod", each.rod), ("body", each.coarse), ("fine body", each.fine)):
            if record is not None and record.status != "converged":
                yield f"- {each.scene.title}, {name}: {record.status}: {record.reason}"


def _refused(scenes: tuple[Scene, ...]) -> Iterator[str]:
    """Scenes of which there is a body alone."""
    titles = [
        scene.title
        for scene in scenes
        if path_of(scene.name, BODY, COARSE).exists()
        and not path_of(scene.name, ROD, COARSE).exists()
    ]
    if titles:
        yield f"- Bodies that no rod is beside, which refuses them by name: {'; '.join(titles)}."

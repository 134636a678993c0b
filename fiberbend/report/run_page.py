"""report.html of a run: case, plan, answer, curves, the body in space and files, in one page."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import IO, Any

import numpy as np

from fiberbend import columns as col
from fiberbend.answer.answer import answer
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.models.choice import choose_model
from fiberbend.report import case_tables
from fiberbend.report.captions import caption, in_short
from fiberbend.report.case_tables import Line
from fiberbend.report.page import (
    Download,
    Picture,
    beside,
    citation,
    data_address,
    inside,
    is_picture,
    link,
    picture,
    render,
)
from fiberbend.results.folder import CASE_FILE, HISTORY_FILE, MESH, REPORT, RUN_FILE, RunFolder
from fiberbend.results.scenery import scenery
from fiberbend.results.space import Space
from fiberbend.results.states import States, read_snapshot, snapshot_paths
from fiberbend.states.labels import short_number
from fiberbend.states.snapshot import Write
from machine.folders import DAMAGED

_MOST_PICTURES = 4_000_000
"""Bytes of pictures of the body that the page contains; further ones are links."""
_PATHS = ("tip_path.*",)
_SECTIONS = ("section_*.*", "cell_*.*", "fiber_*.*")
_BODY = ("rest.*", "undeformed.*", "montage.*", "bent*.*", "cut.*", "animation.*")
_PLANE = (col.TIP_Y, col.TIP_Z)
_ASIDE = 1e-3
"""Part of the path's extent by which it leaves the plane of bending where that is shown."""
_INSIDE = (HISTORY_FILE, CASE_FILE, RUN_FILE)
_BESIDE = ("run.log", "error.log", "actuator.msh", "fields/*.pvd", "fields/*.vtm", "fields/*.vt?")
_MOST_FILES = 60
_PANELS = 4
_ROWS_KEYS = {col.STEP: "step", col.PRESSURE: "pressure_kpa", col.ANGLE: "angle_deg"}


def write_report(
    folder: RunFolder,
    case: Case,
    rows: Sequence[Mapping[str, Any]],
    run: Mapping[str, Any],
) -> None:
    """Write report.html into the folder of a run that is done; on the rank that writes.

    Args:
        folder: has history.csv, run.json, pictures and states of the run, as far as there are any.
        case: its case.
        rows: of history.csv.
        run: content of run.json.

    Raises:
        CaseError: the folder's states do not fit its case.
    """
    if folder.writes:
        folder.write_text(REPORT, report(folder.path, case, rows, run))


def report(
    path: Path,
    case: Case,
    rows: Sequence[Mapping[str, Any]],
    run: Mapping[str, Any],
    links: str = "",
    loose: bool = False,
) -> str:
    """The page of a run, see `write_report`.

    Args:
        path: the run folder.
        case: its case.
        rows: of history.csv; empty where there is none.
        run: content of run.json.
        links: what leads from the page to the folder, such as "runs/finger/"; empty for a page in
            the folder itself.
        loose: the folder will be gone: the page neither names it nor leads to it.
    """
    missing: list[str] = []
    if not rows:
        rows = rows_of_states(path)
        missing.append(
            f"There is no {HISTORY_FILE}: the run did not come to its end. What it kept is shown; "
            "go on with fiberbend run … --resume."
            if rows
            else f"There is no {HISTORY_FILE}: the run has not made a load step."
        )
    known = [dict(row) for row in rows]
    states, space, why_not = _states(path, case, known)
    view, notes = None, [why_not] if why_not else []
    if states is not None:
        from fiberbend.report.scene import scene_data

        found = scene_data(case, states, space, _forces(case, known))
        view, notes = found.content, list(found.notes)
    words = _words(states)
    curves = _curves(path, case, known, words)
    side = _side(case, known, states, space)
    model, why = choose_model(case)
    read = case_tables.read_columns(known)
    versions = run.get("versions") or {}
    return render(
        "run.html",
        title=case.title or (f"{model.name} model" if loose else path.resolve().name),
        folder="" if loose else path.resolve().name,
        status=run.get("status") or "unknown",
        reason=run.get("reason") or "",
        model=model.name,
        why=why,
        answer=answer(case, known, run) if known else None,
        missing=missing,
        warnings=run.get("warnings") or [],
        view=view,
        obstacles=bool(view and view["obstacles"]),
        view_notes=notes,
        curves=curves,
        side=side,
        path_in_space=_pictures(path, _PATHS, words) if known and _leaves_plane(known) else [],
        sections=_sections(path, case, known, states, words),
        body=[each for each in _limited(path, _BODY, links, words) if each.inside or not loose],
        dimensions=list(case_tables.dimensions(case)),
        materials=list(case_tables.materials(case)),
        effects=list(case_tables.effects(case)),
        case_text=case_tables.case_text(case),
        plan=list(case_tables.plan_lines(case)),
        table=case_tables.steps(known, read),
        whole_table=case_tables.steps(known, case_tables.all_columns(known)),
        phases=_phases(run),
        counts=_counts(run),
        made=list(_made(run)),
        downloads=[file for file in _downloads(path, links) if file.inside or not loose],
        cite=citation(),
        version=str(versions.get("fiberbend", "")),
    )


def rows_of_states(path: Path) -> list[dict[str, Any]]:
    """Step, pressure and angle of the states in a folder without history.csv, from rest on."""
    shots = [read_snapshot(file, lambda _: None) for file in snapshot_paths(path)]
    rows = {0: dict.fromkeys(_ROWS_KEYS, 0.0)}
    for shot in shots:
        if shot is not None:
            rows[shot.step] = {key: getattr(shot, name) for key, name in _ROWS_KEYS.items()}
    return [rows[step] for step in sorted(rows)] if len(rows) > 1 else []


def _states(
    path: Path, case: Case, rows: list[dict[str, Any]]
) -> tuple[States | None, Space | None, str]:
    """The states that can be seen in space, or why there are none."""
    if choose_model(case)[0].line:
        return None, None, "This run is a closed form: it has no body that could be seen in space."
    if not rows or not (path / MESH).exists():
        return None, None, "This run kept no states: there is no body to be seen in space."
    states = States(path, case, rows, say=lambda _: None)
    if len(states) < 2:
        return None, None, "This run kept no load step: there is no body to be seen in space."
    try:
        return states, Space(case, states.model_mesh), ""
    except DAMAGED:
        return None, None, f"{MESH} is damaged: there is no body to be seen in space."


# --- pictures ---------------------------------------------------------------------------------


def _words(states: States | None) -> dict[str, str]:
    """Pressure and angle of the states that pictures may show, by their labels."""
    return {} if states is None else {each.label: in_short(each) for each in states.kept}


def _forces(case: Case, rows: Sequence[Mapping[str, Any]]) -> dict[int, str]:
    """What the line of a step says of turns and of obstacles, by the number of the step."""
    beside = scenery(case, rows)
    return {
        step: ", ".join(
            [
                *([f"{beside.times[step]:.3g} s"] if step in beside.times else []),
                *(f"{name} {short_number(turn)}°" for name, turn in beside.turned[step].items()),
                *(
                    f"{name} {short_number(float(np.linalg.norm(force)))} N"
                    for name, force in forces.items()
                ),
            ]
        )
        for step, forces in beside.forces.items()
    }


def _pictures(path: Path, patterns: Sequence[str], words: Mapping[str, str]) -> list[Picture]:
    return [
        picture(file, caption(file.name, words)) for file in _files(path / "pictures", patterns)
    ]


def _files(path: Path, patterns: Sequence[str]) -> list[Path]:
    found = (file for pattern in patterns for file in sorted(path.glob(pattern)))
    return list(dict.fromkeys(found))


def _limited(
    path: Path, patterns: Sequence[str], links: str, words: Mapping[str, str]
) -> list[Picture]:
    """Pictures as far as there is room, the others as links."""
    shown, room = [], _MOST_PICTURES
    for file in _files(path / "pictures", patterns):
        room -= file.stat().st_size
        if room >= 0 and is_picture(file):
            shown.append(picture(file, caption(file.name, words)))
        else:
            text = caption(file.name, words)
            shown.append(Picture(link(file, path, links), text, inside=False))
    return shown


def _curves(
    path: Path, case: Case, rows: Sequence[dict[str, Any]], words: Mapping[str, str]
) -> list[Picture]:
    """The plots of the run, drawn now where it has drawn none; the tip's path is another."""
    there = _files(path / "pictures", ("*.png", "*.svg"))
    if there or not rows:
        others = {*_files(path / "pictures", (*_SECTIONS, *_BODY, *_PATHS))}
        return [picture(file, caption(file.name, words)) for file in there if file not in others]
    from fiberbend.drawing.curves import draw_plots
    from fiberbend.drawing.page import own_style

    angles = [float(np.rad2deg(angle)) for angle in case.output.at_angles]
    with own_style(), _drawn(_PATHS) as (pictures, write):
        draw_plots(
            rows,
            write,
            angles,
            case.title,
            obstacles=convert.obstacle_shapes(case),
            blocked=case.straight,
        )
    return pictures


def _sections(
    path: Path,
    case: Case,
    rows: Sequence[Mapping[str, Any]],
    states: States | None,
    words: Mapping[str, str],
) -> list[Picture]:
    """Pictures of a section or cell in its own plane; where there are none, its shape now."""
    there = _pictures(path, _SECTIONS, words)
    if there or states is None or not states.model_mesh.uniform:
        return there
    from fiberbend.drawing.page import own_style
    from fiberbend.drawing.section import draw_sections

    kept = [each for each in states.kept if each.asked] or list(states.kept[-1:])
    shots = [shot for each in kept[-_PANELS:] if (shot := states.read(each)) is not None]
    others = ("section_str*.*",)
    with own_style(), _drawn(others) as (pictures, write):
        if shots:
            draw_sections(states.model_mesh, shots, write, scenery=scenery(case, rows))
    return pictures


@contextlib.contextmanager
def _drawn(left_out: Sequence[str]) -> Iterator[tuple[list[Picture], Write]]:
    """Pictures that are drawn meanwhile, and what takes them instead of a folder.

    Args:
        left_out: patterns of names that are not drawn.
    """
    pictures: list[Picture] = []

    def write(name: str, fill: Callable[[IO[bytes]], object]) -> None:
        if any(fnmatchcase(name, pattern) for pattern in left_out):
            return
        content = io.BytesIO()
        fill(content)
        pictures.append(Picture(data_address(content.getvalue(), name), caption(name, {})))

    yield pictures, write


def _leaves_plane(rows: Sequence[Mapping[str, Any]]) -> bool:
    """Whether the tip leaves the plane of bending, so that a view from the side is not enough."""
    path = np.array([[row.get(key) or 0.0 for key in (col.TIP_X, *_PLANE)] for row in rows])
    sizes = np.ptp(path, axis=0)
    return bool(sizes[0] > _ASIDE * sizes[1:].max())


def _side(
    case: Case, rows: Sequence[dict[str, Any]], states: States | None, space: Space | None
) -> Picture | None:
    from fiberbend.drawing.page import own_style
    from fiberbend.report.side_view import side_view

    with own_style():
        content = side_view(case, rows, states, space)
    if content is None:
        return None
    text = "Path of the tip."
    if space is not None:
        aside = _leaves_plane(rows)
        text = (
            "Path of the tip, and the actuator's plane x = 0, both seen from the side."
            if aside
            else "Path of the tip, and the actuator cut at x = 0."
        )
        if space.stack is not None:
            text += (
                " The path is that of the tip cap's end; this model draws no caps."
                if aside
                else " Dashed lines stand for the tip cap, which this model leaves out."
            )
    return Picture(data_address(content, "side.svg"), text)


# --- numbers and files ------------------------------------------------------------------------


def _phases(run: Mapping[str, Any]) -> list[tuple[str, float, float]]:
    """Phase, seconds, and its part of the longest; parts of a phase are named after a slash."""
    seconds = {name: float(value) for name, value in (run.get("wall_s") or {}).items()}
    longest = max(seconds.values(), default=0.0) or 1.0
    return [(name, value, value / longest) for name, value in seconds.items()]


def _counts(run: Mapping[str, Any]) -> list[str]:
    names = {
        "unknowns": "unknown",
        "elements": "element",
        "load_steps": "load step",
        "newton_iterations": "Newton iteration",
        "factorisations": "factorisation",
        "cutbacks": "cut-back",
        "ranks": "rank",
    }
    known = [(run[key], text) for key, text in names.items() if run.get(key) is not None]
    counts = [f"{number} {text}{'' if number == 1 else 's'}" for number, text in known]
    memory = run.get("peak_memory_MB")
    return counts if memory is None else [*counts, f"peak memory {memory:.0f} MB"]


def _made(run: Mapping[str, Any]) -> Iterator[Line]:
    """By which command, program and machine the run was made."""
    for name in ("command", "commit", "machine", "blas", "versions"):
        if run.get(name):
            yield Line(name, case_tables.in_words(run[name]))


def _downloads(path: Path, links: str) -> Iterator[Download]:
    for name in _INSIDE:
        if (path / name).exists():
            yield inside(path / name, path)
    for file in _files(path, _BESIDE)[:_MOST_FILES]:
        yield beside(file, path, links)

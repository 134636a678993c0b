"""Fields, pictures and plots of a run, from its snapshots and history."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from fiberbend.case.case import Case
from fiberbend.case.timed.frames import frame_time
from fiberbend.process.beside import Beside
from fiberbend.results.folder import RunFolder
from fiberbend.results.states import States
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.mesh.data import Floats

if TYPE_CHECKING:
    from fiberbend.compare.check import Check
    from fiberbend.drawing.overlay import Overlay
    from fiberbend.drawing.renderer import Renderer
    from fiberbend.drawing.space.obstacles import Scenery
    from fiberbend.results.space import Space


def draw(
    folder: RunFolder,
    case: Case,
    model_mesh: ModelMesh,
    snapshots: Sequence[Snapshot],
    rows: Sequence[dict[str, Any]],
    reason: str | None,
    say: Callable[[str], None],
    check: Check | None = None,
    model: str = "body",
) -> None:
    """Write fields/*.vtu, pictures/* and the plots of a run folder; on rank 0.

    Args:
        folder: where to write; the animation reads the states of all load steps from it.
        case: has the outputs that are wanted, and the requested angles.
        model_mesh: mesh, materials and fibers.
        snapshots: the states to show; none for a run that never converged a step.
        rows: the history.
        reason: why the run ended early, for the plots' titles, or None.
        say: takes a line for the user where nothing can be drawn.
        check: other models and measured points that are drawn beside the curves.
        model: the run's own model.
    """
    output = case.output
    # a section or a cell is small enough to be handed to another process
    own = model_mesh if model_mesh.uniform else None
    overlays = None if check is None else (check.angles, check.forces)
    flat: Beside[list[str]] | None = None
    if output.pictures:
        flat = Beside(
            _draw_flat,
            folder.path,
            case,
            rows,
            reason,
            overlays,
            model,
            own,
            snapshots if own else None,
        )
    try:
        if output.fields and (flat is None or own is None):
            from fiberbend.results.fields import write_fields

            write_fields(folder, case, model_mesh, snapshots, rows, say)
        if output.pictures or output.animation:
            _draw_states(folder, case, model_mesh, snapshots, rows, say)
        for line in [] if flat is None else flat.result():
            say(line)
    finally:
        if flat is not None:
            flat.stop()


def _draw_flat(
    path: Path,
    case: Case,
    rows: Sequence[dict[str, Any]],
    reason: str | None,
    overlays: tuple[Overlay | None, Overlay | None] | None,
    model: str,
    own: ModelMesh | None,
    snapshots: Sequence[Snapshot] | None,
) -> list[str]:
    """Draw what needs no OpenGL: the curves, and a section or cell in its own plane; its fields.

    Returns:
        Lines on what cannot be drawn.
    """
    folder, lines = RunFolder(path), list[str]()
    draw_curves(folder, case, rows, reason, overlays, model, lines.append)
    if own is None:
        return lines
    if snapshots:
        from fiberbend.results.scenery import scenery
        from fiberbend.results.space import Space
        from fiberbend.running import uniform_outputs

        with pictures(lines.append):
            space = Space(case, own)
            uniform_outputs.draw_in_plane(
                own,
                snapshots,
                [space.recovered(state) for state in snapshots],
                lambda name, fill: folder.write(f"pictures/{name}", fill),
                scenery(case, rows),
            )
    if case.output.fields:
        from fiberbend.results.fields import write_fields

        write_fields(folder, case, own, snapshots or (), rows, lines.append)
    return lines


def _draw_states(
    folder: RunFolder,
    case: Case,
    model_mesh: ModelMesh,
    snapshots: Sequence[Snapshot],
    rows: Sequence[dict[str, Any]],
    say: Callable[[str], None],
) -> None:
    """Pictures of states in one window: at rest, as they were asked for, and all in motion."""
    from fiberbend.drawing.renderer import Renderer
    from fiberbend.drawing.space.rest import draw_rest
    from fiberbend.results.scenery import scenery
    from fiberbend.results.space import Space
    from fiberbend.running import uniform_outputs

    def write(name: str, fill: Callable[[IO[bytes]], object]) -> None:
        folder.write(f"pictures/{name}", fill)

    space, beside, uniform = Space(case, model_mesh), scenery(case, rows), model_mesh.uniform
    fields = [space.recovered(state) for state in snapshots]
    if case.output.pictures:
        with pictures(say, f"no pictures{' in space' if uniform else ''}"), Renderer() as renderer:
            write("rest.png", lambda file: draw_rest(space.model_mesh, file, renderer, beside))
            if snapshots and uniform:
                uniform_outputs.draw_in_space(
                    case, space, snapshots, fields, write, renderer, beside
                )
            elif snapshots:
                from fiberbend.drawing.body import draw_pictures

                draw_pictures(space.own, snapshots, write, renderer, fields, beside)
    if case.output.animation:
        with pictures(say, "no animation"), Renderer() as renderer:
            states = States(folder.path, case, list(rows), say)
            frame = None if case.time is None else frame_time(case.time.duration)
            shown = (states, space, renderer, beside, frame)
            write("animation.gif", lambda file: _animate(file, *shown))


def _animate(
    file: IO[bytes],
    states: States,
    space: Space,
    renderer: Renderer,
    beside: Scenery,
    frame: float | None,
) -> None:
    from fiberbend.drawing.space.animation import Animation

    def strained() -> Iterator[tuple[Snapshot, Floats]]:
        for state in states:
            yield space.snapshot(state), space.at_cells(state)

    Animation(space.model_mesh, renderer, beside).write(
        file, strained(), lambda: (space.snapshot(state) for state in states), frame
    )


def draw_curves(
    folder: RunFolder,
    case: Case,
    rows: Sequence[dict[str, Any]],
    reason: str | None,
    overlays: tuple[Overlay | None, Overlay | None] | None = None,
    model: str = "body",
    say: Callable[[str], None] = print,
) -> None:
    """Write the plots of a run of any model into pictures/; on rank 0.

    Args:
        folder: where to write.
        case: names the title and the requested angles.
        rows: the history.
        reason: why the run ended early, or None.
        overlays: other models and measured points beside angles and beside forces.
        model: the run's own model.
        say: takes a line for the user where nothing can be drawn.
    """
    from fiberbend.case import convert
    from fiberbend.drawing.curves import draw_plots

    with pictures(say):
        draw_plots(
            rows,
            lambda name, fill: folder.write(f"pictures/{name}", fill),
            [float(np.rad2deg(angle)) for angle in case.output.at_angles],
            case.title,
            reason,
            *(overlays or (None, None)),
            f"{model} model",
            convert.obstacle_shapes(case),
            case.straight,
        )


def write_page(
    folder: RunFolder,
    case: Case,
    rows: Sequence[dict[str, Any]],
    run: dict[str, Any],
    say: Callable[[str], None],
) -> None:
    """Write report.html where a case wants it; on the rank that writes.

    Args:
        folder: with everything else that the run leaves.
        case: the case.
        rows: the history.
        run: content of run.json; a page that cannot be made is added to its warnings.
        say: takes the warning.
    """
    if not (case.output.report and folder.writes):
        return

    def warn(text: str) -> None:
        say(text)
        run["warnings"].append(text)
        folder.write_run(**run)

    with page(warn):
        from fiberbend.report.run_page import write_report

        write_report(folder, case, rows, run)


@contextlib.contextmanager
def page(say: Callable[[str], None]) -> Iterator[None]:
    """Write a report meanwhile; a page that cannot be made costs a line, not the results."""
    try:
        yield
    except OSError:
        # a disk that is full lacks more than a page
        raise
    except Exception as error:
        what = (str(error).splitlines() or [""])[0]
        say(f"no report, writing it failed: {type(error).__name__}: {what}")


def draw_at_rest(folder: RunFolder, case: Case, say: Callable[[str], None]) -> None:
    """Write rest.png of a run that has no mesh; on rank 0.

    Args:
        folder: where to write.
        case: the case.
        say: takes a line for the user where nothing can be drawn.
    """
    from fiberbend.drawing.renderer import Renderer
    from fiberbend.drawing.space.rest import draw_rest
    from fiberbend.results.at_rest import body_at_rest, threads
    from fiberbend.results.scenery import scenery

    with pictures(say, "no picture at rest"), Renderer() as renderer:
        body, beside = body_at_rest(case), scenery(case)
        folder.write(
            "pictures/rest.png",
            lambda file: draw_rest(body, file, renderer, beside, threads(case)),
        )


@contextlib.contextmanager
def pictures(say: Callable[[str], None], lacking: str = "no pictures") -> Iterator[None]:
    """Draw meanwhile; what cannot be drawn costs its pictures and a line, not the results.

    Args:
        say: takes the line.
        lacking: its beginning.
    """
    from fiberbend.drawing.page import own_style
    from fiberbend.drawing.renderer import PictureError

    try:
        with own_style():
            yield
    except PictureError as error:
        say(f"{lacking}: {error}")
    except OSError:
        # a disk that is full lacks more than pictures
        raise
    except Exception as error:
        what = (str(error).splitlines() or [""])[0]
        say(f"{lacking}, drawing failed: {type(error).__name__}: {what}")

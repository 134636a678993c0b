"""Fields, pictures and plots of a run, from its snapshots and history."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from typing import IO, Any

import numpy as np

from fiberbend.case.case import Case
from fiberbend.compare.check import Check
from fiberbend.results.folder import RunFolder
from fiberbend.states.recovery import recover
from fiberbend.states.snapshot import ModelMesh, Snapshot


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
    """Write fields/*.vtu, pictures/*.png and the plots of a run folder; on rank 0.

    Args:
        folder: where to write.
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

    def into(sub: str) -> Callable[[str, Callable[[IO[bytes]], object]], None]:
        return lambda name, fill: folder.write(f"{sub}/{name}", fill)

    if output.pictures:
        draw_curves(folder, case, rows, reason, check, model, say)
    if not (snapshots and (output.fields or output.pictures)):
        return
    if model_mesh.uniform:
        from fiberbend.running.uniform_outputs import draw_states

        draw_states(folder, case, model_mesh, snapshots, say)
        return
    fields = [recover(model_mesh, snapshot) for snapshot in snapshots]
    if output.fields:
        from fiberbend.states.paraview import write_fields

        write_fields(model_mesh, snapshots, into("fields"), fields)
    if output.pictures:
        from fiberbend.drawing.body import draw_pictures

        with pictures(say):
            draw_pictures(model_mesh, snapshots, into("pictures"), fields)


def draw_curves(
    folder: RunFolder,
    case: Case,
    rows: Sequence[dict[str, Any]],
    reason: str | None,
    check: Check | None = None,
    model: str = "body",
    say: Callable[[str], None] = print,
) -> None:
    """Write the plots of a run of any model into pictures/; on rank 0.

    Args:
        folder: where to write.
        case: names the title and the requested angles.
        rows: the history.
        reason: why the run ended early, or None.
        check: other models and measured points that are drawn beside the curves.
        model: the run's own model.
        say: takes a line for the user where nothing can be drawn.
    """
    from fiberbend.drawing.curves import draw_plots

    with pictures(say):
        draw_plots(
            rows,
            lambda name, fill: folder.write(f"pictures/{name}", fill),
            [float(np.rad2deg(angle)) for angle in case.output.at_angles],
            case.title,
            reason,
            None if check is None else check.angles,
            None if check is None else check.forces,
            f"{model} model",
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

"""The fields of a run for ParaView: which states, which halves, which obstacles."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.results.folder import RunFolder
from fiberbend.results.space import Space
from fiberbend.results.states import States, at_rest
from fiberbend.states.recovery import NodalFields
from fiberbend.states.snapshot import ModelMesh, Snapshot

FOLDER = "fields"
WHOLE_ANYWAY = "output.field_halves: both has no effect, the body is solved whole"


def write_fields(
    folder: RunFolder,
    case: Case,
    model_mesh: ModelMesh,
    snapshots: Sequence[Snapshot],
    rows: Sequence[dict[str, Any]],
    say: Callable[[str], None],
    recovered: Mapping[int, NodalFields] | None = None,
) -> list[str]:
    """Write the fields of rest and of the states that a case asks for, or of all load steps.

    Args:
        folder: the run folder; where all steps are wanted, their states are read from it.
        case: the case.
        model_mesh: mesh, materials and fibers as the model solves them.
        snapshots: the states that were asked for, in their order.
        rows: the history.
        say: takes a line for the user where a setting has no effect or a file is damaged.
        recovered: `Space.recovered` of states at hand, by the number of the load step.

    Returns:
        The names of the files within `FOLDER`.
    """
    from fiberbend.states.paraview import Series

    both = case.output.field_halves == "both"
    space = Space(case, model_mesh, both)
    if both and space.halves is None:
        say(WHOLE_ANYWAY)
    states: Iterable[Snapshot] = [at_rest(model_mesh), *snapshots]
    if case.output.field_steps == "all":
        states = States(folder.path, case, list(rows), say)
    series = Series(
        space.model_mesh,
        lambda name, fill: folder.write(f"{FOLDER}/{name}", fill),
        convert.obstacle_shapes(case),
    )
    for state in states:
        own = (recovered or {}).get(state.step)
        series.add(space.snapshot(state), space.fields(state, own))
    return series.finish()

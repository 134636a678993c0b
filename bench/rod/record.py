"""Runs that are kept: histories of bodies and rods, what they cost and where they are from."""

from __future__ import annotations

import dataclasses
import json
import resource
from pathlib import Path
from typing import Any

from bench.rod.scenes import Scene
from fiberbend import run

FOLDER = Path(__file__).resolve().parent / "records"
DIGITS = 7
"""Of the values that are kept."""
LEFT_OUT = ("energy_", "balance_", "min_det", "volume_error", "clamp_", "analytic", "section_")
"""Beginnings of columns that no table needs."""


@dataclasses.dataclass(frozen=True)
class Record:
    """A run.

    Attributes:
        case: that was solved.
        status: how it ended.
        reason: why so.
        cpu_s: processor time of the call of `fiberbend.run`, kernels compiled before.
        first_cpu_s: of a call before, which made the tables; None: there was none.
        compiled: whether kernels had to be compiled nevertheless.
        unknowns: of the model.
        iterations: of Newton's method.
        versions: of what it depends on.
        commit: of the source.
        columns: names.
        rows: values of the columns at every kept state.
    """

    case: dict[str, Any]
    status: str
    reason: str
    cpu_s: float
    first_cpu_s: float | None
    compiled: bool
    unknowns: int | None
    iterations: int | None
    versions: dict[str, str]
    commit: str | None
    columns: tuple[str, ...]
    rows: tuple[tuple[float | None, ...], ...]

    def column(self, name: str) -> list[float]:
        """Values of a column from rest on.

        Raises:
            KeyError: it has none of that name.
        """
        if name not in self.columns:
            raise KeyError(f"no column {name} among {', '.join(self.columns)}")
        place = self.columns.index(name)
        return [float("nan") if row[place] is None else float(row[place]) for row in self.rows]  # type: ignore[arg-type]


def path_of(scene: str, model: str, mesh: str) -> Path:
    """File of a record."""
    return FOLDER / f"{scene}.{model}.{mesh}.json"


def solve(
    scene: Scene, model: str, mesh: str, out: Path | None = None, twice: bool = False
) -> Record:
    """Run a scene.

    Args:
        scene: which.
        model: by which model.
        mesh: of which mesh.
        out: folder for the whole run; None: only the record is kept.
        twice: solve it once before, so that tables are made.
    """
    case = scene.case(model, mesh)
    first = None
    if twice:
        began = _seconds()
        run(case, force=True, states=False)
        first = round(_seconds() - began, 3)
    began = _seconds()
    result = run(case, out=out, overwrite=True, force=True)
    spent = _seconds() - began
    about = result.run
    names = _columns(result.rows)
    return Record(
        case=case,
        status=result.status,
        reason=result.reason,
        cpu_s=round(spent, 3),
        first_cpu_s=first,
        compiled=bool(about.get("wall_s", {}).get("compile", 0.0) > _QUICK),
        unknowns=about.get("unknowns"),
        iterations=about.get("newton_iterations"),
        versions=about.get("versions", {}),
        commit=about.get("commit"),
        columns=names,
        rows=tuple(tuple(_rounded(row.get(name)) for name in names) for row in result.rows),
    )


_QUICK = 5.0
"""Seconds in which kernels are loaded; more: they were compiled."""


def _seconds() -> float:
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def _columns(rows: list[dict[str, Any]]) -> tuple[str, ...]:
    names = dict.fromkeys(name for row in rows for name in row)
    return tuple(name for name in names if not name.startswith(LEFT_OUT))


def _rounded(value: Any) -> float | None:
    return None if value is None else float(f"{float(value):.{DIGITS}g}")


def keep(record: Record, path: Path) -> None:
    """Write it, a row a line."""
    path.parent.mkdir(exist_ok=True)
    about = dataclasses.asdict(record)
    rows = about.pop("rows")
    head = json.dumps(about, indent=1, ensure_ascii=False)
    lines = ",\n".join("  " + json.dumps(row) for row in rows)
    path.write_text(f'{head[:-2]},\n "rows": [\n{lines}\n ]\n}}\n', encoding="utf-8")


def read(path: Path) -> Record:
    """A record as it was kept."""
    content = json.loads(path.read_text(encoding="utf-8"))
    content.setdefault("first_cpu_s", None)
    content["columns"] = tuple(content["columns"])
    content["rows"] = tuple(tuple(row) for row in content["rows"])
    return Record(**content)

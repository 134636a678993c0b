"""The ladder as a table: CSV for programs, Markdown for people."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Sequence
from typing import Any

from fiberbend.answer.numbers import number as digits
from fiberbend.ladder.advice import advice, pareto
from fiberbend.ladder.errors import FamilyLimit, Judged, Judgement
from fiberbend.ladder.record import Record
from fiberbend.ladder.rungs import Missing, Rung
from fiberbend.ladder.words import brief, full_name, percent, seconds, settings, title

_COUNTS = ("wall_s", "cpu_s", "once_s", "solve_wall_s", "solve_cpu_s", "unknowns", "load_steps")
_MORE = ("iterations", "peak_memory_MB")


def as_csv(judgement: Judgement, solved: Sequence[tuple[Rung, Record]]) -> str:
    """Every solved rung with its values and errors, also those that failed.

    Args:
        judgement: the errors.
        solved: all rungs that were solved.
    """
    known = {each.record.name: each for each in judgement.rungs}
    best = {each.record.name for each in pareto(judgement)}
    rows = [_csv_row(rung, record, known.get(record.name), judgement) for rung, record in solved]
    for row in rows:
        row["on_front"] = int(row["rung"] in best)
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]) if rows else ["rung"], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _csv_row(
    rung: Rung, record: Record, judged: Judged | None, judgement: Judgement
) -> dict[str, Any]:
    row: dict[str, Any] = {"rung": record.name}
    row |= {name: "" if value is None else value for name, value in record.family.items()}
    row |= {"section": record.mesh.get("section", ""), "axial_mm": record.mesh.get("axial_mm", "")}
    row |= {"status": record.status, "reason": record.reason}
    row |= {name: getattr(record, name) for name in (*_COUNTS, *_MORE)}
    for name, part in (("error", "size"), ("mesh_error", "mesh_size"), ("model_error", "model")):
        row[f"{name}_percent"] = _cell(judged.worst(part)) if judged else ""
    for each in judgement.asked:
        error = judged.errors.get(each.name) if judged else None
        row[each.name] = record.values.get(each.name, "")
        for part in ("total", "mesh", "model"):
            row[f"{each.name}_{part}_error_percent"] = _cell(getattr(error, part, math.nan))
    return row | {"left_out": "; ".join(rung.left_out), "settings": settings(rung)}


def _cell(value: float) -> str:
    return f"{value:.6g}" if math.isfinite(value) else ""


def as_markdown(
    heading: str,
    judgement: Judgement,
    solved: Sequence[tuple[Rung, Record]],
    missing: Sequence[Missing],
    typed: Sequence[str] = (),
) -> str:
    """Advice, rungs by time, limits of the families, and what is not there, for a reader."""
    lines = [f"# {heading}", "", advice(judgement), ""]
    if typed:
        lines += ["```console", *(f"$ {line}" for line in typed), "```", ""]
    lines += [*_reference(judgement), ""]
    if text := waiting(solved):
        lines += [f"**{text[0].upper()}{text[1:]}.**", ""]
    lines += [*rung_table(judgement), "", *limit_table(judgement), ""]
    lines += [*_once(solved), *_absent(solved, missing)]
    return "\n".join(lines).rstrip() + "\n"


def waiting(solved: Sequence[tuple[Rung, Record]]) -> str:
    """What has to be said of times that a busy machine has made longer; empty where nothing."""
    count = sum(record.waited for _, record in solved)
    if not count:
        return ""
    return (
        f"{count} of {len(solved)} rungs waited for the processor: their times are those of a busy "
        "machine (with another --out they are measured again)"
    )


def rung_table(judgement: Judgement) -> list[str]:
    """A row for each rung, the quickest first; in bold those that no other beats."""
    best = {each.record.name for each in pareto(judgement)}
    head = ["rung", "error", "mesh", "model", "time (s)", "CPU (s)", "solve (s)", "solve CPU (s)"]
    head += ["unknowns", "steps", "iterations", "memory (MB)"]
    lines = [f"| {' | '.join(head)} |", "|---|" + "---:|" * (len(head) - 1)]
    for each in sorted(judgement.rungs, key=lambda judged: judged.record.wall_s):
        record = each.record
        name = full_name(each.rung)
        cells = [f"**{name}**" if record.name in best else name]
        cells += [_percent(each.worst(part)) for part in ("size", "mesh_size", "model")]
        cells += [_seconds(value) for value in _times(record)]
        cells += [str(record.unknowns or "–"), str(record.load_steps), str(record.iterations)]
        lines.append(f"| {' | '.join([*cells, f'{record.peak_memory_MB:.0f}'])} |")
    return lines


def limit_table(judgement: Judgement) -> list[str]:
    """What every family tends to, how well that is known, and the observed orders."""
    names = [f"{each.label} ({each.unit})" for each in judgement.asked]
    lines = [f"| limit of | {' | '.join(names)} | order, remarks |"]
    lines.append("|---|" + "---:|" * len(names) + "---|")
    for family, found in judgement.limits.items():
        cells = [title(family)]
        cells += [_limit(found.get(each.name)) for each in judgement.asked]
        mark = " (reference)" if family == judgement.reference else ""
        lines.append(f"| {' | '.join([cells[0] + mark, *cells[1:], _remarks(found.values())])} |")
    return lines


def _reference(judgement: Judgement) -> list[str]:
    if judgement.reference is None:
        return ["Nothing to compare with: no family has a limit."]
    asked = ", ".join(each.label for each in judgement.asked)
    return [
        f"The case asks for: {asked}. Errors are against the limit of "
        f'"{title(judgement.reference)}", which is itself known to '
        f"{percent(judgement.known_to())}. A row has the greatest error over all that is asked "
        "for; error is mesh plus model, added without their signs. In bold: no other rung is "
        "both quicker and more exact."
    ]


def _once(solved: Sequence[tuple[Rung, Record]]) -> Iterator[str]:
    """What of the times is spent once for many runs."""
    longest = max((record.once_s for _, record in solved), default=0.0)
    if longest > 0:
        yield (
            f"A calibrated winding needs a calibration by the cell, here up to {seconds(longest)}. "
            "It is done once for a section and kept for all later runs. The times have it in them; "
            "without it they are those at the left ends of the thin lines in the picture (`once_s` "
            "in accuracy.csv)."
        )
        yield ""


def _limit(found: FamilyLimit | None) -> str:
    if found is None:
        return "–"
    value, uncertain = found.limit.value, found.limit.uncertainty
    if not math.isfinite(uncertain):
        return f"{digits(value, 5, 5)} ± ?"
    if uncertain == 0:
        return digits(value, 5, 5)
    share = 100 * uncertain / abs(value) if value else math.inf
    return f"{digits(value, 5, 5)} ± {percent(share)}"


def _remarks(found: Any) -> str:
    orders: dict[str, list[float]] = {}
    remarks: dict[str, None] = {}
    for each in found:
        for direction, order in each.orders.items():
            orders.setdefault(direction, []).append(order)
        remarks |= dict.fromkeys(filter(None, each.limit.remark.split("; ")))
    parts = []
    for direction, values in orders.items():
        low, high = min(values), max(values)
        span = " to ".join(dict.fromkeys((f"{low:.1f}", f"{high:.1f}")))
        parts.append(f"{direction}: {span}")
    return "; ".join([*parts, *remarks]) or "no mesh"


def _absent(solved: Sequence[tuple[Rung, Record]], missing: Sequence[Missing]) -> Iterator[str]:
    """Rungs that failed or stopped early, families and rungs that are not there."""
    ended = [record for _, record in solved if record.status != "converged"]
    yield from _ended(
        "Rungs that failed. They are not in the picture and count nowhere; `--retry` solves them "
        "again:",
        [record for record in ended if not record.values],
    )
    yield from _ended(
        "Rungs that came to a part of what is asked for. They are pale in the picture and never "
        "advised:",
        [record for record in ended if record.values],
    )
    left_out = {text: title(rung.family) for rung, _ in solved for text in rung.left_out}
    if left_out:
        yield "Left out by a model:"
        yield ""
        yield from (f"- {name} leaves out {text}" for text, name in left_out.items())
        yield ""
    if missing:
        yield "Not in this ladder:"
        yield ""
        yield from (f"- {each.name}: {each.reason}" for each in missing)


def _ended(head: str, records: Sequence[Record]) -> Iterator[str]:
    if records:
        yield head
        yield ""
        yield from (f"- {each.name}: {each.status}, {brief(each.reason)}" for each in records)
        yield ""


def _times(record: Record) -> tuple[float, ...]:
    return record.wall_s, record.cpu_s, record.solve_wall_s, record.solve_cpu_s


def _percent(value: float) -> str:
    return percent(value) if math.isfinite(value) else "?"


def _seconds(value: float) -> str:
    return f"{value:.1f}" if value < 100 else f"{value:.0f}"

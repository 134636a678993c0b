"""The command `fiberbend accuracy`: solve the rungs of a case one by one, and judge them."""

from __future__ import annotations

import dataclasses
import math
import re
import shlex
import statistics
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from fiberbend.ladder.advice import advice, chosen, pareto
from fiberbend.ladder.asked import asked
from fiberbend.ladder.errors import Judgement, Solved, judge
from fiberbend.ladder.record import FAILED, LATE, Record, Store, find
from fiberbend.ladder.rungs import Ladder, Missing, Rung, ladder
from fiberbend.ladder.table import waiting
from fiberbend.ladder.words import brief, seconds, settings, title
from fiberbend.plan.memory import gigabytes, room, shortage
from fiberbend.process.signals import stop_of
from fiberbend.running import launch
from fiberbend.schema.problems import CaseError, Problem, meant

Say = Callable[[str], None]
Solve = Callable[[Rung, float | None, bool], Record]
_TIME = re.compile(r"\s*([0-9]*\.?[0-9]+)\s*(s|min|h)\s*")
_SECONDS = {"s": 1.0, "min": 60.0, "h": 3600.0}
_LATE = 3.0
"""A rung is stopped after as many times what `within` allows: estimates are not exact."""


@dataclasses.dataclass(frozen=True)
class Options:
    """What of a ladder is solved, and how.

    Attributes:
        within: seconds that a rung may be expected to take; no bound by default.
        only: words of the rungs to solve; all by default.
        retry: solve failed rungs again.
        force: solve rungs for which memory seems short.
        dry: say what would be solved.
        quiet: no progress; the advice alone.
        verbose: load steps of the rungs too, and the whole table.
    """

    within: float | None = None
    only: tuple[str, ...] = ()
    retry: bool = False
    force: bool = False
    dry: bool = False
    quiet: bool = False
    verbose: bool = False


def duration(text: str) -> float:
    """Seconds of a time such as "60s" or "2 min".

    Raises:
        CaseError: it is none.
    """
    found = _TIME.fullmatch(text)
    value = float(found[1]) * _SECONDS[found[2]] if found else 0.0
    if not 0 < value < math.inf:
        raise CaseError(
            [Problem("--within", f'"{text}", expected a time above zero, such as 60s or 2min')]
        )
    return value


def run_ladder(
    path: Path,
    out: Path,
    changes: Sequence[str] = (),
    options: Options | None = None,
    say: Say = print,
    solve: Solve | None = None,
) -> int:
    """Solve the rungs of a case that are not solved yet; write table, picture and advice.

    Args:
        path: the case file.
        out: the folder; started again, the ladder goes on there.
        changes: changes to the case.
        options: what is solved, and how.
        say: takes lines for the user.
        solve: solves a rung; a process each by default.

    Returns:
        The exit code: 0, 2 where a rung failed or there is nothing to compare, or that of a signal.

    Raises:
        CaseError: case, options or folder are wrong; nothing has been solved.
    """
    options = options or Options()
    if launch.size() > 1:
        text = "under mpirun, expected one process: rungs are timed on one rank, one at a time"
        raise CaseError([Problem("fiberbend accuracy", text)])
    if solve is None:
        from fiberbend.ladder.solve import Processes

        solve = Processes()
    whole = ladder(path, changes)
    part = _part(whole, options)
    tell = (lambda _: None) if options.quiet else say
    if options.dry:
        _plan(part, out, options, say)
        return 0
    store = Store(out)
    try:
        return _run(_Work(path, tuple(changes), store, whole, part, options, say, tell, solve))
    finally:
        store.close()


@dataclasses.dataclass(frozen=True)
class _Work:
    """What a ladder is solved with."""

    path: Path
    changes: tuple[str, ...]
    store: Store
    whole: Ladder
    part: Ladder
    options: Options
    say: Say
    tell: Say
    solve: Solve


def _run(work: _Work) -> int:
    stop = None
    missing = list(work.part.missing)
    try:
        missing += _solve(work)
    except KeyboardInterrupt as error:
        stop = stop_of(error)
    # what an earlier call has solved beyond --only and --within counts too
    found = [(rung, work.store.find(rung)) for rung in work.whole.rungs]
    solved = [(rung, record) for rung, record in found if record is not None]
    known = {rung.name for rung, _ in solved}
    absent = [each for each in missing if each.name not in known]
    absent += _left_out(work, known | {each.name for each in absent})
    if not solved:
        work.say("no rung is solved" + ("" if stop else f": {_why(absent)}"))
        return stop.code if stop else launch.FAILED
    judgement = _write(work, solved, absent, pictures=stop is None)
    if text := waiting(solved):
        work.say(f"warning: {text}")
    failed = [record for _, record in solved if record.status == FAILED]
    for record in failed:
        work.say(f"failed: {record.name}: {brief(record.reason)}")
    if stop is not None:
        work.say("interrupted; the same command goes on where it was")
        return stop.code
    return launch.FAILED if failed or judgement.reference is None else 0


def _left_out(work: _Work, known: set[str]) -> list[Missing]:
    """What --only, or a signal before its turn, has left out, by family."""
    families: dict[str, int] = {}
    for rung in work.whole.rungs:
        if rung.name not in known:
            families[rung.family.key] = families.get(rung.family.key, 0) + 1
    return [
        Missing(name, f"{count} {'rungs' if count > 1 else 'rung'} not solved yet")
        for name, count in families.items()
    ]


def _why(absent: Sequence[Missing]) -> str:
    return "; ".join(f"{each.name}: {each.reason}" for each in absent[:3]) or "there is none"


def _part(whole: Ladder, options: Options) -> Ladder:
    """The rungs that are asked for and expected to be done in time."""
    missing, rungs = list(whole.missing), list(whole.rungs)
    if options.only:
        words = {word for rung in rungs for word in rung.family.key.split("-")}
        words |= {rung.name for rung in rungs}
        unknown = [
            Problem(
                f"--only {word}",
                f"no rung of this case has it, expected {', '.join(sorted(_heads(rungs)))}"
                f"{meant(word, words)}",
            )
            for word in options.only
            if not any(_has(rung, word) for rung in rungs)
        ]
        if unknown:
            raise CaseError(unknown)
        rungs = [rung for rung in rungs if any(_has(rung, word) for word in options.only)]
    if options.within is not None:
        late = [rung for rung in rungs if rung.seconds > options.within]
        for rung in late:
            text = f"about {seconds(rung.seconds)} expected, more than --within allows"
            missing.append(Missing(rung.name, text))
        rungs = [rung for rung in rungs if rung not in late]
    return Ladder(tuple(rungs), tuple(missing))


def _heads(rungs: Sequence[Rung]) -> set[str]:
    return {rung.family.key for rung in rungs} | {rung.family.model for rung in rungs}


def _has(rung: Rung, word: str) -> bool:
    """Whether a rung is named by its name, or by some words of its family in their order."""
    wanted, parts = word.split("-"), iter(rung.family.key.split("-"))
    return word == rung.name or all(each in parts for each in wanted)


def _plan(part: Ladder, out: Path, options: Options, say: Say) -> None:
    """What would be solved, with expected time and memory."""
    free = None if options.force else room()
    before, fit = [], []
    for rung in part.rungs:
        size = f"{rung.unknowns} unknowns" if rung.unknowns else "closed form"
        line = (
            f"{rung.name:48s} {size:>16s}  about {seconds(rung.seconds)}, "
            f"{gigabytes(rung.memory_mb)}"
        )
        if find(out, rung) is not None:
            before.append(rung)
            line += "  (solved before)"
        elif shortage([rung.memory_mb], free) is not None:
            line += "  (left out: more memory than is free)"
        else:
            fit.append(rung)
        say(line)
    for each in part.missing:
        say(f"not {each.name}: {each.reason}")
    say(_sum(part.rungs, before, fit))


def _sum(every: Sequence[Rung], before: Sequence[Rung], fit: Sequence[Rung]) -> str:
    """The last line of a plan: what is left to do, in time and memory."""
    parts = [f"{len(every)} rungs"]
    if before:
        parts.append(f"{len(before)} solved before")
    short = len(every) - len(before) - len(fit)
    if short:
        parts.append(f"{short} left out for want of memory")
    if fit:
        parts.append(f"about {seconds(sum(rung.seconds for rung in fit))} one after the other")
        parts.append(f"at most {gigabytes(max(rung.memory_mb for rung in fit))} of memory")
    return ", ".join(parts)


def _outdated(store: Store, left: Sequence[Rung]) -> str:
    """Which rungs are solved again because something else than their mesh has changed."""
    found = [names for rung in left if (names := store.outdated(rung))]
    if not found:
        return ""
    changed = ", ".join(dict.fromkeys(name for names in found for name in names))
    count = f"{len(found)} {'rungs were' if len(found) > 1 else 'rung was'}"
    return f"{count} solved with another {changed}: solved again"


def _solve(work: _Work) -> list[Missing]:
    """Solve what is left, one rung at a time; returns what memory does not allow."""
    left, store, options = [], work.store, work.options
    for rung in work.part.rungs:
        record = store.find(rung)
        if record is None or (options.retry and record.status == FAILED):
            left.append(rung)
    total, before = len(work.part.rungs), len(work.part.rungs) - len(left)
    expected = sum(rung.seconds for rung in left)
    to_come = f", about {seconds(expected)} to go" if left else ""
    work.tell(f"{total} rungs, {before} solved before{to_come}")
    if text := _outdated(store, left):
        work.tell(text)
    missing, ratios = [], []
    for number, rung in enumerate(left):
        short = None if options.force else shortage([rung.memory_mb], room(), "the rung")
        if short is not None:
            missing.append(Missing(rung.name, short))
            work.tell(f"not {rung.name}: {short}")
            continue
        most = None if options.within is None else _LATE * options.within
        record = work.solve(rung, most, options.verbose and not options.quiet)
        if record.status == LATE:
            missing.append(Missing(record.name, record.reason))
        else:
            store.keep(record)
        ratios.append(record.wall_s / rung.seconds)
        to_go = statistics.median(ratios[-5:]) * sum(each.seconds for each in left[number + 1 :])
        reason = f" ({record.status}: {brief(record.reason)})" if record.reason else ""
        more = f", about {seconds(to_go)} to go" if to_go else ""
        work.tell(
            f"[{before + number + 1:2d}/{total}] {record.name:48s} {seconds(record.wall_s):>8s}"
            f"{reason}{more}"
        )
    return missing


def _write(
    work: _Work, solved: Sequence[Solved], missing: Sequence[Missing], pictures: bool
) -> Judgement:
    from fiberbend.ladder.picture import draw
    from fiberbend.ladder.table import as_csv, as_markdown, rung_table

    case = work.whole.rungs[0].case
    answered = [(rung, record) for rung, record in solved if record.values]
    judgement = judge(asked(case), answered, work.whole.rungs)
    heading = case.title or work.path.stem
    folder = work.store.folder
    folder.write_text("accuracy.csv", as_csv(judgement, solved))
    typed = _typed(work, judgement)
    folder.write_text("accuracy.md", as_markdown(heading, judgement, solved, missing, typed))
    work.store.conclude(_found(judgement, solved, missing, typed))
    if pictures and judgement.reference is not None:
        launch.settle_folders()
        folder.write("accuracy.png", lambda file: draw(judgement, heading, file))
    if work.options.verbose:
        for line in rung_table(judgement):
            work.say(line)
    if judgement.reference is not None:
        work.tell(f"reference: the limit of {title(judgement.reference)}")
    work.say("\n".join([advice(judgement), *(f"  {line}" for line in typed)]))
    what = "table" if judgement.reference is None else "table and picture"
    work.tell(f"{what} in {work.store.path}")
    return judgement


def _typed(work: _Work, judgement: Judgement) -> list[str]:
    """The commands that solve the rungs of the advice."""
    path = shlex.quote(str(work.path))
    return [
        f"fiberbend run {path} {settings(each.rung, work.changes)}" for each in chosen(judgement)
    ]


def _found(
    judgement: Judgement,
    solved: Sequence[Solved],
    missing: Sequence[Missing],
    typed: Sequence[str],
) -> dict[str, Any]:
    """Content of accuracy.json."""
    known = judgement.known_to()
    return {
        "advice": advice(judgement),
        "commands": list(typed),
        "reference": None if judgement.reference is None else judgement.reference.key,
        "reference_known_to_percent": known if math.isfinite(known) else None,
        "front": [each.record.name for each in pareto(judgement)],
        "rungs": [record.name for _, record in solved],
        "missing": [dataclasses.asdict(each) for each in missing],
    }

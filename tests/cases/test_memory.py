"""Memory is compared with what is free before anything is meshed, and refused with both figures."""

from __future__ import annotations

import contextlib
import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from fiberbend import run
from fiberbend.cli import main
from fiberbend.models.choice import meshed
from fiberbend.models.costs.price import price
from fiberbend.plan import estimate, memory
from fiberbend.plan.memory import Room, gigabytes, needed_mb, room, shortage
from fiberbend.plan.plan import make_plan
from fiberbend.reader.reader import read_case
from fiberbend.schema.problems import CaseError
from tests.conftest import ROOT

BASELINE = str(ROOT / "cases" / "free_bending.yaml")
LONG = ["actuator.length=16 m", "output={}"]
GB = 1e9


def machine(
    root: Path,
    available: float | None = 8 * GB,
    group: str = "",
    files: dict[str, str] | None = None,
) -> Path:
    """A system's files on memory: free bytes, the control groups of this process, their limits."""
    content = {"proc/self/cgroup": group, **(files or {})}
    if available is not None:
        content["proc/meminfo"] = f"MemTotal: 1 kB\nMemAvailable:   {int(available / 1024)} kB\n"
    for name, text in content.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text, encoding="utf-8")
    return root


def second(limit: str, used: float, cached: float = 0, path: str = "job") -> dict[str, str]:
    """Files of a control group of version 2."""
    folder = f"sys/fs/cgroup/{path}"
    return {
        f"{folder}/memory.max": f"{limit}\n",
        f"{folder}/memory.current": f"{int(used)}\n",
        f"{folder}/memory.stat": f"anon 1\ninactive_file {int(cached)}\n",
    }


def first(limit: float, used: float, cached: float = 0) -> dict[str, str]:
    """Files of a control group of version 1."""
    folder = "sys/fs/cgroup/memory/job"
    return {
        f"{folder}/memory.limit_in_bytes": f"{int(limit)}\n",
        f"{folder}/memory.usage_in_bytes": f"{int(used)}\n",
        f"{folder}/memory.stat": f"cache 1\ntotal_inactive_file {int(cached)}\n",
    }


@pytest.mark.parametrize(
    ("group", "files", "gb"),
    [
        ("", {}, 8.0),
        ("0::/job\n", second(str(int(4 * GB)), 1 * GB), 3.0),
        # what is cached from files is given back
        ("0::/job\n", second(str(int(4 * GB)), 3 * GB, 2 * GB), 3.0),
        # a group within has no limit, the one around it has
        ("0::/job/step\n", second(str(int(2 * GB)), 0) | second("max", 0, 0, "job/step"), 2.0),
        ("0::/job\n", second("max", 1 * GB), 8.0),
        ("5:cpu:/job\n4:memory:/job\n", first(4 * GB, 3.5 * GB, 0.5 * GB), 1.0),
        ("4:memory:/job\n", first(2**63 - 4096, 1 * GB), 8.0),
        # of a container that sees its own limit only at the top
        ("0::/of/the/host\n", second(str(int(3 * GB)), 1 * GB, 0, "."), 2.0),
        ("0::/job\n", second(str(int(1 * GB)), 2 * GB), 0.0),
    ],
)
def test_free_memory_is_the_least_of_system_and_control_groups(
    tmp_path: Path, group: str, files: dict[str, str], gb: float
) -> None:
    found = room(machine(tmp_path, group=group, files=files))
    assert found is not None
    assert found.mb == pytest.approx(1e3 * gb, rel=1e-5, abs=1e-6)
    assert ("control group" in found.source) == (gb != 8.0)


def test_where_the_system_does_not_say_nothing_is_refused(tmp_path: Path) -> None:
    assert room(machine(tmp_path, available=None)) is None
    assert shortage([1e9], None) is None
    assert room() is not None, "this system says"


def test_a_shortage_has_both_figures() -> None:
    text = shortage([3000, 2500], Room(4000, "of this machine"), "the sweep")
    assert text is not None
    assert text.startswith(
        "the sweep needs about 5.5 GB (2 at once), 4 GB are free of this machine"
    )
    assert "--force" in text
    assert shortage([3000], Room(3000, "")) is None
    assert [gigabytes(mb) for mb in (61234.0, 137.0, 6.9e6, 0.0)] == [
        "61 GB", "0.14 GB", "6900 GB", "0 GB",
    ]  # fmt: skip


def tight(monkeypatch: pytest.MonkeyPatch, mb: float) -> None:
    """Little is free."""
    for module in (memory, estimate):
        monkeypatch.setattr(module, "room", lambda: Room(mb, "of this machine"))


def test_plan_refuses_what_does_not_fit(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    tight(monkeypatch, 8000.0)
    settings = [word for setting in LONG for word in ("--set", setting)]
    start = time.perf_counter()
    assert main(["plan", BASELINE, *settings]) == 1
    assert time.perf_counter() - start < 5, "nothing is meshed for it"
    out, err = capsys.readouterr()
    assert "8 GB are free of this machine" in out
    assert err.startswith("memory: the run needs about ")
    assert main(["plan", BASELINE, *settings, "--force"]) == 0
    assert main(["plan", BASELINE]) == 0


def test_a_run_is_refused_before_its_folder_is_touched(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tight(monkeypatch, 400.0)
    case = read_case(BASELINE, ["model=section", "effects.0.pressure.to=1 kPa", "output={}"])
    with pytest.raises(CaseError, match=r"memory: the run needs about 0\.4\d GB, 0\.4 GB are free"):
        run(case, tmp_path / "run")
    assert not (tmp_path / "run").exists()
    # without a folder there are no pictures, and it fits
    assert run(case).status == "converged"


def test_force_overrides(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tight(monkeypatch, 1.0)
    case = read_case(
        BASELINE,
        ["model=section", "effects.0.pressure.to=1 kPa", "output={pictures: false, fields: false}"],
    )
    with pytest.raises(CaseError, match="--force"):
        run(case)
    assert run(case, tmp_path / "run", force=True).status == "converged"


def test_ranks_and_pictures_need_more() -> None:
    body = read_case(BASELINE, ["mesh.axial=4 mm"])
    assert needed_mb(body, 3) - needed_mb(body, 1) == pytest.approx(400)
    assert needed_mb(body) > needed_mb(body, folder=False) + 300
    slow: list[list[str]] = [[], ["effects.1.winding.pitch=1 mm"], ["effects.1.winding.as=smeared"]]
    coarse, close, spread = (
        needed_mb(read_case(BASELINE, ["mesh.axial=4 mm", *more])) for more in slow
    )
    assert coarse < close
    assert coarse < spread


def test_plans_of_many_steps_and_elements_come_at_once() -> None:
    start = time.perf_counter()
    case = read_case(BASELINE, ["model=section", "solver.max_turn=0.004 deg"])
    steps = make_plan(case).steps
    assert steps is not None
    assert steps > 8e4
    huge: Any = read_case(BASELINE, ["model=cell", "mesh.axial=1e-6 mm", "mesh.section=16"])
    assert make_plan(huge).elements > 1e8
    assert time.perf_counter() - start < 5


def test_a_sweep_counts_the_points_that_run_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two of 0.14 GB fit into 0.3 GB, three do not; the largest of them count."""
    from fiberbend.sweep import command
    from fiberbend.sweep.crews import crew, pool

    solved: list[int] = []

    @contextlib.contextmanager
    def idle(self: pool.Pool, _points: int) -> Iterator[None]:
        solved.append(self.count)
        yield None

    monkeypatch.setattr(pool.Pool, "at_work", idle)
    monkeypatch.setattr(command, "_write", lambda *_args, **_more: None)
    monkeypatch.setattr(crew, "room", lambda: Room(300.0, "of this machine"))
    file = tmp_path / "sweep.yaml"
    quiet = "{pictures: false, fields: false}"
    file.write_text(
        f"case: {BASELINE}\nset: {{model: section, output: {quiet}}}\n"
        "vary: {actuator.radius: [7 mm, 8 mm, 9 mm]}\n",
        encoding="utf-8",
    )
    point = read_case(BASELINE, ["model=section"])
    run_sweep = command.run_sweep
    run_sweep(file, tmp_path / "two", jobs=2, say=lambda _: None)
    size = meshed(point).size(point)
    each = price("section", size.kind).memory_mb(size.unknowns, size.layers)
    assert 100 < each < 150  # libraries at least, and two in 0.3 GB
    needs = re.escape(f"the sweep needs about {gigabytes(3 * each)} (3 at once), 0.3 GB are")
    with pytest.raises(CaseError, match=needs):
        run_sweep(file, tmp_path / "three", jobs=3, say=lambda _: None)
    run_sweep(file, tmp_path / "three", jobs=3, force=True, say=lambda _: None)
    assert solved == [2, 3]

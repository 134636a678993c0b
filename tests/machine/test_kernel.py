"""Kernels of OpenBLAS: chosen by what the processor can do, and each of them right."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from machine import kernel, origin

SAPPHIRE = {
    "avx",
    "avx2",
    "fma",
    "avx512f",
    "avx512cd",
    "avx512dq",
    "avx512bw",
    "avx512vl",
    "amx_tile",
}
ZEN2 = {"avx", "avx2", "fma", "sse4_2"}
KNIGHTS = {"avx", "avx2", "fma", "avx512f", "avx512cd", "avx512er", "avx512pf"}
KERNELS = ("Prescott", "Nehalem", "Sandybridge", "Haswell", "SkylakeX")

CHECK = """
import json, sys
from mpi4py import MPI
import numpy as np
from petsc4py import PETSc

from fem.solver.factor import Factor
from machine import origin

rng = np.random.default_rng(5)
# whole numbers: every order of the sums gives the same product
a, b = (rng.integers(-9, 10, (150, 170)).astype(float) for _ in range(2))
product = a @ b.T
right = a.astype(int) @ b.T.astype(int)

n, m = 130, 40
stiff = rng.integers(-3, 4, (n, n)).astype(float)
stiff = stiff @ stiff.T + n * np.eye(n)
side = rng.integers(-3, 4, (m, n)).astype(float)
dense = np.block([[stiff, side.T], [side, np.zeros((m, m))]])
matrix = PETSc.Mat().createDense(dense.shape, array=dense, comm=PETSc.COMM_SELF)
matrix = matrix.convert("sbaij")
factor = Factor(matrix)
factor.renew()
known = rng.integers(-5, 6, n + m).astype(float)
x, y = matrix.createVecs()
y.array_w[:] = dense @ known
factor.solve(y, x)
print(json.dumps({
    "kernel": origin.blas()["kernel"],
    "product": float(np.abs(product - right).max()),
    "solution": float(np.abs(x.array_r - known).max()),
    "bound": 100 * np.finfo(float).eps * float(np.linalg.cond(dense)),
    "negative": [factor.negative_pivots, m],
}))
"""


def test_the_flags_choose_and_only_where_openblas_has_lost_its_way() -> None:
    assert kernel.better("Prescott", SAPPHIRE) == "SkylakeX"
    assert kernel.better("Prescott", ZEN2) == "Haswell"
    # AVX-512 of another kind
    assert kernel.better("Prescott", KNIGHTS) == "Haswell"
    assert kernel.better("Nehalem", {"avx"}) == "Sandybridge"
    for own in ("SkylakeX", "SapphireRapids", "Zen", "Haswell", "Sandybridge", "ARMV8", None):
        assert kernel.better(own, SAPPHIRE) is None
    # it is the right one there
    assert kernel.better("Prescott", {"sse3"}) is None
    assert kernel.better("Prescott", set()) is None


def test_flags_of_linux(tmp_path: Path) -> None:
    listed = tmp_path / "cpuinfo"
    listed.write_text("processor\t: 0\nflags\t\t: fpu avx avx2 fma\nflags\t: none\n")
    assert kernel.processor_flags(listed) == {"fpu", "avx", "avx2", "fma"}
    listed.write_text("processor\t: 0\nFeatures\t: fp asimd\n")
    assert kernel.processor_flags(listed) == set()
    assert kernel.processor_flags(tmp_path / "none") == set()


@pytest.fixture
def fresh(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[int]:
    """A process before numpy, on a processor that OpenBLAS does not know; how often it is asked."""
    asked: list[int] = []
    library = tmp_path / "libopenblas.so"
    library.write_bytes(b"one")

    def answer() -> dict[str, str]:
        asked.append(1)
        return {"kernel": "Prescott", "path": str(library)}

    monkeypatch.delenv(kernel.CORE, raising=False)
    monkeypatch.delitem(sys.modules, "numpy", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "cache").mkdir(mode=0o700)
    monkeypatch.setattr(kernel, "processor_flags", lambda: ZEN2)
    monkeypatch.setattr(kernel, "_asked", answer)
    return asked


def test_openblas_is_asked_once_and_again_when_it_is_another(
    fresh: list[int], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for times in (1, 1):
        monkeypatch.delenv(kernel.CORE, raising=False)
        kernel.settle_kernel()
        assert (os.environ[kernel.CORE], len(fresh)) == ("Haswell", times)
    (tmp_path / "libopenblas.so").write_bytes(b"another")
    monkeypatch.delenv(kernel.CORE)
    kernel.settle_kernel()
    assert (os.environ[kernel.CORE], len(fresh)) == ("Haswell", 2)
    (kept,) = (tmp_path / "cache" / "fiberbend").glob("openblas-*.json")
    kept.write_text("[")
    monkeypatch.delenv(kernel.CORE)
    kernel.settle_kernel()
    assert (os.environ[kernel.CORE], len(fresh)) == ("Haswell", 3)
    assert json.loads(kept.read_text())["kernel"] == "Prescott"


def test_a_kernel_set_outside_is_kept_and_a_loaded_library_left_alone(
    fresh: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(kernel.CORE, "Nehalem")
    kernel.settle_kernel()
    assert os.environ[kernel.CORE] == "Nehalem"
    monkeypatch.delenv(kernel.CORE)
    monkeypatch.setitem(sys.modules, "numpy", sys)
    kernel.settle_kernel()
    assert kernel.CORE not in os.environ
    assert not fresh
    # what can still be done is said
    assert f"{kernel.CORE}=Haswell" in kernel.slow_kernel({"kernel": "Prescott"})
    assert kernel.slow_kernel({"kernel": "Zen"}) == kernel.slow_kernel(None) == ""


def test_this_openblas_tells_its_own_choice() -> None:
    if "OpenBLAS" not in (origin.blas() or {}).get("library", ""):
        pytest.skip("another BLAS")
    found = kernel._asked()
    assert found is not None
    assert found["kernel"]
    assert Path(found["path"]).exists()


@pytest.mark.parametrize("name", KERNELS)
def test_products_and_factors_of_every_kernel_that_this_processor_can_take(name: str) -> None:
    needed = dict(kernel._BY_FLAGS).get(name, set())
    if not needed <= kernel.processor_flags() or not kernel.processor_flags():
        pytest.skip(f"this processor has no {', '.join(sorted(needed))}")
    environment = os.environ | {kernel.CORE: name}
    command = [sys.executable, "-c", CHECK]
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    found = json.loads(done.stdout)
    assert found["kernel"] == name
    assert found["product"] == 0
    assert found["solution"] < found["bound"] < 1e-8
    assert found["negative"][0] == found["negative"][1]

"""Which kernels OpenBLAS takes: on a processor that it does not know, those of twenty years ago.

OpenBLAS picks by the processor's model. One that is newer than the library gets kernels without
AVX, a quarter as fast (OpenBLAS 0.3.21 on Sapphire Rapids: 15 instead of 65 Gflop/s). What the
processor can do stands in its flags, so that they choose, where OpenBLAS itself would not.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import sys
from pathlib import Path
from typing import Any

from machine.folders import MachineError, cache_root, make_private, refusal

CORE = "OPENBLAS_CORETYPE"
"""What OpenBLAS reads when it is loaded."""
_BY_FLAGS = (
    ("SkylakeX", {"avx512f", "avx512cd", "avx512dq", "avx512bw", "avx512vl", "fma", "avx2"}),
    ("Haswell", {"avx2", "fma"}),
    ("Sandybridge", {"avx"}),
)
"""Kernels from the fastest on, and the instructions that they use. Linux lists a flag only where it
keeps the registers that belong to it."""
_WITHOUT_AVX = {
    *("Katmai", "Coppermine", "Northwood", "Prescott", "Banias", "Atom", "Core2", "Penryn"),
    *("Dunnington", "Nehalem", "Athlon", "Opteron", "Opteron_SSE3", "Barcelona", "Nano", "Bobcat"),
}
"""Kernels that a processor with AVX gets only where OpenBLAS does not know it."""
_ASK = """
import json, numpy
from machine import origin
print(json.dumps((origin.blas() or {}) | {"path": str(origin.blas_file())}))
"""
_LONG = 60.0


def best(flags: set[str]) -> str | None:
    """The fastest kernel whose instructions a processor has; None where it has no AVX.

    Args:
        flags: as Linux lists them.
    """
    return next((kernel for kernel, needed in _BY_FLAGS if needed <= flags), None)


def better(own: str | None, flags: set[str]) -> str | None:
    """The kernel to take instead of OpenBLAS's own choice; None to leave it alone.

    Args:
        own: OpenBLAS's choice; None where another library computes.
        flags: of the processor.
    """
    return best(flags) if own in _WITHOUT_AVX else None


def settle_kernel() -> None:
    """Name a kernel to OpenBLAS where its own choice is a bad one, before numpy is loaded.

    A value set outside is kept. OpenBLAS is asked once for each of its versions and processors, in
    a process of its own; the answer is kept in the cache.
    """
    flags = processor_flags()
    if CORE in os.environ or "numpy" in sys.modules or best(flags) is None:
        return
    kernel = better(_own(flags), flags)
    if kernel is not None:
        os.environ[CORE] = kernel


def slow_kernel(loaded: dict[str, Any] | None) -> str:
    """A line for the user where the loaded OpenBLAS is slower than need be; else empty.

    Args:
        loaded: what `machine.origin.blas` says.
    """
    kernel = better((loaded or {}).get("kernel"), processor_flags())
    if kernel is None or CORE in os.environ:
        return ""
    return f"{CORE}={kernel}, set before numpy is loaded, makes linear algebra several times faster"


def processor_flags(proc: Path = Path("/proc/cpuinfo")) -> set[str]:
    """Instruction sets of an x86 processor under Linux; else nothing.

    Args:
        proc: where the system lists them.
    """
    with contextlib.suppress(OSError), proc.open(encoding="utf-8") as lines:
        for line in lines:
            name, _, value = line.partition(":")
            if name.strip() == "flags":
                return set(value.split())
    return set()


def _own(flags: set[str]) -> str | None:
    """OpenBLAS's own choice of a kernel for this Python; None where it does not tell."""
    key = hashlib.sha256("|".join([sys.executable, sys.version, *sorted(flags)]).encode())
    try:
        place = cache_root().path / f"openblas-{key.hexdigest()[:12]}.json"
    except MachineError:
        return None
    with contextlib.suppress(OSError, ValueError, KeyError, TypeError):
        kept = json.loads(place.read_text(encoding="utf-8"))
        if kept["size"] == os.stat(kept["path"]).st_size:
            return str(kept["kernel"])
    found = _asked()
    if not found or not found.get("kernel"):
        return None
    kept = {"kernel": found["kernel"], "path": found["path"]}
    with contextlib.suppress(OSError, MachineError):
        make_private(place.parent)
        if not refusal(place.parent):
            draft = place.with_suffix(f".{os.getpid()}")
            size = os.stat(found["path"]).st_size
            draft.write_text(json.dumps(kept | {"size": size}), encoding="utf-8")
            draft.replace(place)
    return str(found["kernel"])


def _asked() -> dict[str, Any] | None:
    import subprocess

    root = str(Path(__file__).resolve().parent.parent)
    # mpirun's variables would make the process a rank
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("OMPI_", "PMIX_"))}
    environment["PYTHONPATH"] = os.pathsep.join(
        [root, *filter(None, [os.environ.get("PYTHONPATH")])]
    )
    with contextlib.suppress(OSError, subprocess.SubprocessError, ValueError):
        command = [sys.executable, "-P", "-c", _ASK]
        done = subprocess.run(
            command, env=environment, capture_output=True, timeout=_LONG, check=True, text=True
        )
        found: dict[str, Any] | None = json.loads(done.stdout)
        return found
    return None

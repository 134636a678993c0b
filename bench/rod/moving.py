"""What a step of a rod in motion costs: `python -m bench.rod.moving [CASE ...]`."""

from __future__ import annotations

import sys
import time
from itertools import islice
from pathlib import Path

from fiberbend.reader.reader import read_case
from fiberbend.slender.actuator import slender
from fiberbend.slender.timed import timed

CASES = ("cases/swing.yaml",)
STEPS, TIMES = 60, 9


def cost(path: str) -> tuple[float, float, float]:
    """Processor time of the first steps of a case, again and again.

    Args:
        path: of a case with `time`.

    Returns:
        Least and middle one, ms a step, and iterations of Newton's method a step.
    """
    case = read_case(Path(path), ["output={pictures: false, report: false}"])
    motion = timed(case, slender(case))
    found, iterations = [], 0
    for _ in range(TIMES):
        begin = time.process_time()
        passed = list(islice(motion.run(), STEPS + 1))
        found.append(1e3 * (time.process_time() - begin) / (len(passed) - 1))
        iterations = sum(each.moving.iterations for each in passed)
    found.sort()
    return found[0], found[len(found) // 2], iterations / STEPS


if __name__ == "__main__":
    for name in sys.argv[1:] or CASES:
        least, middle, iterations = cost(name)
        print(
            f"{name}: {least:.2f} ms of processor time a step, {middle:.2f} ms in the middle of "
            f"{TIMES} runs of {STEPS} steps; {iterations:.2f} iterations a step"
        )

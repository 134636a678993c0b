"""The process that solves one rung: as `fiberbend run` does, with the processor time of phases.

Arguments: the case file, the run folder, the file for what only this process knows, and `quiet` or
`verbose`.
"""

from __future__ import annotations

import ctypes
import json
import os
import signal
import sys
import time
from pathlib import Path

_DIE_WITH_PARENT = 1
"""PR_SET_PDEATHSIG of Linux's prctl."""


def main(arguments: list[str]) -> int:
    """Solve; the exit code is that of `fiberbend run`."""
    begun = time.process_time()
    case_file, folder, notes, talk, parent = arguments
    ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)
    if os.getppid() != int(parent):
        return 1
    from fiberbend.process import signals

    signals.install()
    from fiberbend.reader.reader import read_case
    from fiberbend.running import launch
    from fiberbend.running.progress import Progress
    from fiberbend.schema.problems import CaseError
    from machine.folders import MachineError, cache_root

    class Timed(Progress):
        """Knows the processor time of each phase too."""

        def __init__(self) -> None:
            super().__init__(quiet=talk == "quiet", verbose=talk == "verbose")
            self.cpu_s: dict[str, float] = {}
            self._last, self._since = "start", begun

        def phase(self, name: str) -> None:
            self._note(name)
            super().phase(name)

        def close(self) -> None:
            self._note("")
            super().close()

        def _note(self, name: str) -> None:
            now = time.process_time()
            self.cpu_s[self._last] = self.cpu_s.get(self._last, 0.0) + now - self._since
            self._last, self._since = name, now

    def compiled() -> int:
        return sum(1 for _ in cache_root().path.glob("*/*.so"))

    try:
        case = read_case(case_file)
        before = compiled()
        launch.set_threads()
        launch.start_mpi()
        from fiberbend.running.runner import run_case

        progress = Timed()
        with signals.raising():
            result = run_case(case, Path(folder), progress=progress, force=True)
        progress.close()
        found = {"cpu_s": progress.cpu_s, "compiled": compiled() - before}
        Path(notes).write_text(json.dumps(found), encoding="utf-8")
    except (CaseError, MachineError) as error:
        print(error, file=sys.stderr)
        return 1
    except KeyboardInterrupt as error:
        return signals.stop_of(error).code
    return launch.FAILED if result.status == "failed" else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

"""Who solves the points of a sweep, as the loop over them sees it; and this process alone."""

from __future__ import annotations

import abc
import contextlib
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from pathlib import Path
from typing import Any, TypeVar

from fiberbend.plan.memory import room, shortage
from fiberbend.running import launch

T = TypeVar("T")
Submit = Callable[..., "Future[Any]"]
"""`submit` of an executor of concurrent.futures: a function and its arguments."""


class Crew(abc.ABC):
    """Who solves the points of a sweep. One process leads: it reads, hands out and reports.

    Attributes:
        count: how many points are solved at once.
        fewer: what would make them fewer.
    """

    count: int
    fewer = ""

    def led(self, action: Callable[[], T]) -> T | None:
        """What an action of the process that leads gives; None in those that serve it.

        Raises:
            Exception: of the action, in every process.
        """
        return action()

    def blind(self, folder: Path) -> str:
        """Who does not see a folder that the process that leads has made; the same in every one."""
        return ""

    def shortage(self, needs: Sequence[float]) -> str | None:
        """Why what is solved at once does not fit into memory, or None; the same in every process.

        Args:
            needs: memory of each point, the largest first, MB; of the process that leads.
        """
        return shortage(needs[: self.count], room(), "the sweep")

    @abc.abstractmethod
    def at_work(self, points: int) -> contextlib.AbstractContextManager[Submit | None]:
        """Within, points can be submitted; None in those that have served to the end of it.

        Args:
            points: how many there are; of the process that leads.
        """

    def death(self, error: BaseException) -> int | None:
        """Exit code of the process that has died of a task, if this is what its error says."""
        return None

    def ended(self, code: int) -> int:
        """The exit code of the process that leads, in every process."""
        return code


class Here(Crew):
    """This process solves one point after the other."""

    count = 1

    @contextlib.contextmanager
    def at_work(self, points: int) -> Iterator[Submit]:
        """What is submitted is done at once."""
        launch.start_mpi()
        yield _done


def _done(function: Callable[..., Any], *arguments: Any) -> Future[Any]:
    future: Future[Any] = Future()
    future.set_result(function(*arguments))
    return future

"""Arrays as text that a page contains and its script unpacks."""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray


def packed(values: NDArray[Any]) -> str:
    """An array compressed: all first bytes of its numbers, then all second ones, and so on.

    Sorted so, numbers of several bytes that change little become much smaller.

    Args:
        values: of any shape, little-endian.
    """
    numbers = np.ascontiguousarray(values)
    planes = numbers.view(np.uint8).reshape(-1, numbers.itemsize).T
    return base64_of(zlib.compress(planes.tobytes(), 6))


def base64_of(data: bytes) -> str:
    """Bytes as text."""
    return base64.b64encode(data).decode("ascii")

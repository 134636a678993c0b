"""`python -m fiberbend` is the command `fiberbend`."""

import os
import sys

# Python puts the working folder first in the path: a file yaml.py beside a case would be imported.
_ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
if not sys.flags.safe_path and sys.path and sys.path[0] == os.getcwd() != _ROOT:
    del sys.path[0]

from fiberbend.cli import entry  # noqa: E402

if __name__ == "__main__":
    entry()

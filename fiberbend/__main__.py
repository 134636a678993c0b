"""`python -m fiberbend` is the command `fiberbend`."""

import sys

from fiberbend.cli import main

if __name__ == "__main__":
    sys.exit(main())

"""Do what README and the tutorial say, and take the pictures that they show from there.

`make pictures` runs it; names of pages on the command line renew only theirs.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

from bench.doc_commands import ROOT, Reader, pages, pictures


def main(names: list[str]) -> None:
    """Renew the pictures of some pages, or of all that have any.

    Args:
        names: paths of pages from the root of the repository; none for all.
    """
    for page in pages():
        wanted = list(pictures(page))
        if not wanted or (names and str(page.relative_to(ROOT)) not in names):
            continue
        with tempfile.TemporaryDirectory() as folder:
            reader = Reader(Path(folder))
            reader.follow(page)
            for picture in wanted:
                shutil.copy(reader.folder / picture.source, picture.target)
                print(picture.target.relative_to(ROOT))


if __name__ == "__main__":
    main(sys.argv[1:])

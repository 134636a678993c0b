"""Do what README and the tutorial say, and take the pictures that they show from there.

`make pictures` runs it; names of pages on the command line renew only theirs.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from bench.doc_commands import ROOT, Reader, pages, pictures


def _take(source: Path, target: Path) -> None:
    """Copy a picture, or photograph a page as a browser shows it.

    Args:
        source: a picture or an HTML file.
        target: a PNG file.
    """
    if source.suffix != ".html":
        shutil.copy(source, target)
        return
    graphics = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    window = ["--headless", "--no-sandbox", "--hide-scrollbars", "--window-size=1150,1500"]
    # the page has so much of its own time to draw
    wait = ["--virtual-time-budget=10000", f"--screenshot={target}", source.as_uri()]
    subprocess.run(["chromium", *graphics, *window, *wait], check=True, capture_output=True)


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
                _take(reader.folder / picture.source, picture.target)
                print(picture.target.relative_to(ROOT))


if __name__ == "__main__":
    main(sys.argv[1:])

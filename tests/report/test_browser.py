"""Reports in headless Chromium: nothing fetched, no error, and the view in space moves."""

from __future__ import annotations

import io
import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from fiberbend.report.run_page import write_report
from fiberbend.results.folder import REPORT, RunFolder
from tests.report.folders import bent_folder, case, rows, run_of

playwright = pytest.importorskip(
    "playwright.sync_api", reason="playwright is not installed (pip install -e .[docs])"
)

CHROMIUM = Path("/usr/bin/chromium")
WEBGL = ("--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
_EDGE = 6
LOCAL = ("file:", "data:", "blob:")

pytestmark = pytest.mark.skipif(
    not CHROMIUM.exists(), reason=f"{CHROMIUM} is not there (apt-get install chromium)"
)


class Browser:
    """A report that is open, and what has happened since it was opened."""

    def __init__(self, page: Any, path: Path) -> None:
        self.page = page
        self.requests: list[str] = []
        self.errors: list[str] = []
        page.on("request", lambda request: self.requests.append(request.url))
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on("console", self._console)
        page.goto(path.as_uri())
        page.locator("#view[data-drawn]").wait_for()

    def _console(self, message: Any) -> None:
        # software rendering warns of being slow
        if message.type in ("error", "warning") and "GPU stall" not in message.text:
            self.errors.append(message.text)

    def picture(self) -> NDArray[Any]:
        """Pixels of the view without its edge, where the focus is marked, (height, width, 3)."""
        from PIL import Image

        self.settle()
        shot = self.page.locator("#view").screenshot()
        pixels = np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"), dtype=int)
        return pixels[_EDGE:-_EDGE, _EDGE:-_EDGE]

    def settle(self) -> None:
        """Wait until what was asked for is drawn."""
        frames = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
        self.page.evaluate(frames)

    def step(self, number: int) -> None:
        """Move the slider by the keyboard, from its first place."""
        slider = self.page.locator("#step")
        slider.focus()
        slider.press("Home")
        for _ in range(number):
            slider.press("ArrowRight")

    def text(self) -> str:
        """What is written about the step."""
        return str(self.page.locator("#step-text").inner_text())


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = bent_folder(tmp_path_factory.mktemp("browser") / "a run #1", case(), run_of())
    write_report(RunFolder(path), case(), rows(), run_of())
    return path / REPORT


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with playwright.sync_playwright() as library:
        browser = library.chromium.launch(executable_path=str(CHROMIUM), args=[*WEBGL])
        yield browser
        browser.close()


@pytest.fixture
def open_page(chromium: Any, report: Path) -> Iterator[Browser]:
    page = chromium.new_page(viewport={"width": 1000, "height": 900})
    opened = Browser(page, report)
    yield opened
    assert opened.errors == []
    assert [url for url in opened.requests if not url.startswith(LOCAL)] == []
    page.close()


def differ(a: NDArray[Any], b: NDArray[Any]) -> int:
    """Pixels that are not alike."""
    return int((np.abs(a - b).max(axis=2) > 24).sum())


def test_the_body_is_seen(open_page: Browser) -> None:
    picture = open_page.picture()
    ground = picture[2, 2]
    seen = np.abs(picture - ground).max(axis=2) > 24
    assert 0.02 < seen.mean() < 0.9
    assert len(np.unique(picture[seen] // 16, axis=0)) > 20
    pixels = open_page.page.evaluate(
        """() => {
          const gl = document.getElementById("view").getContext("webgl2");
          const pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
          gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA,
            gl.UNSIGNED_BYTE, pixels);
          return pixels.reduce((sum, value) => sum + (value > 0), 0);
        }"""
    )
    assert pixels > 10_000


def test_the_slider_goes_through_all_steps(open_page: Browser) -> None:
    assert open_page.text() == "step 3: 70.0 kPa, θ = 70.0°"
    pictures = []
    for number, angle in enumerate(("0.0", "20.0", "45.0", "70.0")):
        open_page.step(number)
        assert open_page.text() == f"step {number}: {angle} kPa, θ = {angle}°"
        pictures.append(open_page.picture())
    for a, b in itertools.pairwise(pictures):
        assert differ(a, b) > 1000


def test_mouse_and_keys_turn_the_body(open_page: Browser) -> None:
    pictures = [open_page.picture()]
    box = open_page.page.locator("#view").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    open_page.page.mouse.move(x, y)
    open_page.page.mouse.down()
    open_page.page.mouse.move(x + 90, y + 40, steps=4)
    open_page.page.mouse.up()
    pictures.append(open_page.picture())
    view = open_page.page.locator("#view")
    view.focus()
    for key in ("ArrowRight", "ArrowUp", "+"):
        view.press(key)
        pictures.append(open_page.picture())
    for a, b in itertools.pairwise(pictures):
        assert differ(a, b) > 300
    view.press("Home")
    assert differ(open_page.picture(), pictures[0]) < 100


@pytest.mark.parametrize("box", ["show-fibers", "show-obstacles", "show-body", "show-sheath"])
def test_parts_can_be_chosen(open_page: Browser, box: str) -> None:
    before = open_page.picture()
    checked = open_page.page.locator(f"#{box}").is_checked()
    assert checked == (box != "show-sheath")
    open_page.page.locator(f"#{box}").click()
    assert differ(before, open_page.picture()) > 300


def test_the_first_picture_is_as_large_as_its_frame_and_others_are_at_one_scale(
    open_page: Browser,
) -> None:
    def extent() -> tuple[float, float]:
        """Parts of the frame's height and width that are filled."""
        open_page.settle()
        picture = open_page.picture()
        seen = np.abs(picture - picture[2, 2]).max(axis=2) > 24
        places = np.argwhere(seen[:-90])
        tall, wide = (np.ptp(places, axis=0) + 1) / seen.shape
        return float(tall), float(wide)

    for box in ("show-obstacles", "show-fibers"):
        open_page.page.locator(f"#{box}").uncheck()
    open_page.page.locator("#fit-step").click()
    own = extent()
    assert max(own) > 0.75
    open_page.page.locator("#fit-all").click()
    last = extent()
    open_page.step(0)
    assert max(extent()) < 1.0
    assert max(last) <= max(own)
    open_page.step(3)
    assert extent() == pytest.approx(last, abs=0.01)


def test_the_marks_of_the_bar_are_where_their_values_are(open_page: Browser) -> None:
    bar = open_page.page.locator("#bar-colors").bounding_box()
    for name in ("strain", "stress"):
        open_page.page.locator("#quantity").select_option(name)
        for number, mark in enumerate(open_page.page.locator("#bar-ticks span").all()):
            box = mark.bounding_box()
            middle = box["x"] + box["width"] / 2
            assert middle == pytest.approx(bar["x"] + bar["width"] * number / 4, abs=1.0)


def test_a_cut_opens_the_chamber(open_page: Browser) -> None:
    before = open_page.picture()
    open_page.page.locator("#show-cut").check()
    assert differ(before, open_page.picture()) > 1000


def test_colours_can_be_chosen(open_page: Browser) -> None:
    pictures = [open_page.picture()]
    for name in ("stress", "regions", "strain"):
        open_page.page.locator("#quantity").select_option(name)
        assert open_page.page.locator("#bar").is_visible() == (name != "regions")
        pictures.append(open_page.picture())
    for a, b in itertools.pairwise(pictures):
        assert differ(a, b) > 1000
    assert differ(pictures[0], pictures[-1]) == 0


def test_the_colours_are_those_of_the_bar(open_page: Browser) -> None:
    """With the faint shade that gives it a shape: at most 14 % darker, in the same proportions."""
    open_page.step(0)
    for box in ("show-fibers", "show-obstacles"):
        open_page.page.locator(f"#{box}").uncheck()
    picture = open_page.picture()
    seen = picture[np.abs(picture - picture[2, 2]).max(axis=2) > 40].astype(float)
    bar = open_page.page.evaluate(
        "Array.from(document.getElementById('bar-colors').getContext('2d')"
        ".getImageData(0, 0, 1, 1).data)"
    )
    shade = seen / np.array(bar[:3])
    inside = np.median(shade, axis=0)
    assert (np.abs(inside - inside.mean()) < 0.05).all()
    assert 0.84 < inside.mean() < 1.02


def test_play_goes_on_to_the_last_step(open_page: Browser) -> None:
    button = open_page.page.locator("#play")
    button.click()
    assert button.inner_text() == "Pause"
    assert open_page.text().startswith("step 0")
    open_page.page.get_by_role("button", name="Play").wait_for()
    assert open_page.text().startswith("step 3")


def test_a_narrow_screen_needs_no_sideways_scrolling(open_page: Browser) -> None:
    open_page.page.set_viewport_size({"width": 380, "height": 800})
    open_page.settle()
    wide = open_page.page.evaluate("document.documentElement.scrollWidth")
    assert wide <= 380
    assert open_page.picture().shape[1] <= 380


def test_a_browser_without_webgl_says_so(chromium: Any, report: Path) -> None:
    page = chromium.new_page()
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    page.goto(report.as_uri())
    message = page.locator("#view-message")
    message.wait_for(state="visible")
    assert "cannot be drawn here" in message.inner_text()
    assert page.locator("#view-controls").is_hidden()
    page.close()

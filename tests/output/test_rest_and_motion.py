"""Pictures in space at rest and in motion, and from a run to its pictures."""

from __future__ import annotations

import dataclasses
import io
import math
from pathlib import Path
from typing import IO, Any

import numpy as np
import pytest

from fem.march.records import Report
from fiberbend.drawing.body import draw_pictures
from fiberbend.drawing.renderer import Renderer
from fiberbend.drawing.space.animation import SIZE, Animation
from fiberbend.drawing.space.obstacles import Scenery
from fiberbend.drawing.space.rest import draw_rest, rest_image
from fiberbend.results.at_rest import body_at_rest, threads
from fiberbend.results.folder import RunFolder
from fiberbend.results.reading import read_history
from fiberbend.results.scenery import scenery
from fiberbend.results.states import States
from fiberbend.running.messages import on_state
from fiberbend.running.outputs import draw
from fiberbend.running.runner import run_case
from fiberbend.states.obstacles import Box
from tests.output.bending import model_mesh, snapshot
from tests.output.space import WINDING, case, frames

CASES = Path(__file__).resolve().parents[2] / "cases"

OBLIQUE = (-0.62, 0.42, -0.66)
SIZE_OF = (400, 300)


# --- at rest ---------------------------------------------------------------------------------

ROOF = Scenery(
    {"roof": Box((-2.0, 13.0, 0.0), (2.0, 15.0, 24.0))}, lengths={"wall": 2.0, "chamber": 24.25}
)


@pytest.mark.parametrize(
    ("half", "element", "smeared"),
    [(True, "hexahedron", False), (False, "hexahedron", True), (True, "tetrahedron", False)],
)
def test_at_rest(renderer: Renderer, half: bool, element: str, smeared: bool) -> None:
    scene = dataclasses.replace(model_mesh(half=half, element=element), smeared=smeared)
    rest = rest_image(scene, renderer, ROOF, width=800)
    assert [text for text, _ in rest.lengths] == ["chamber 24.25 mm", "32 mm", "14 mm", "22 mm"]
    # whatever is modelled, half of it is cut open: wall, floor and sheath are seen
    hues = rest.image.reshape(-1, 3).astype(int)
    orange = (hues[:, 0] > hues[:, 2] + 60).sum()
    blue = (hues[:, 2] > hues[:, 0] + 25).sum()
    assert orange > 500
    assert blue > 500
    file = io.BytesIO()
    draw_rest(scene, file, renderer, ROOF)
    assert file.getbuffer().nbytes > 20_000


def test_half_and_whole_look_alike_at_rest(renderer: Renderer) -> None:
    images = [
        rest_image(dataclasses.replace(model_mesh(half=half), fibers=None), renderer, width=500)
        for half in (True, False)
    ]
    gap = np.abs(images[0].image.astype(int) - images[1].image.astype(int)).max(axis=2)
    assert (gap > 40).mean() < 0.01


@pytest.mark.parametrize("how", ["smeared", "discrete"])
def test_an_actuator_is_drawn_from_its_case_alone(renderer: Renderer, how: str) -> None:
    wound = case(
        effects=[{"pressure": {"to": "9 kPa"}}, {"winding": WINDING["winding"] | {"as": how}}]
    )
    body, lines = body_at_rest(wound), threads(wound)
    assert body.smeared == (how == "smeared")
    assert len(lines) == (0 if body.smeared else wound.turns.curves)
    rest = rest_image(body, renderer, scenery(wound), lines, 700)
    assert rest.names[-1] == ("winding" if body.smeared else "fiber")
    whole = wound.actuator.length + 2 * wound.actuator.cap
    assert [text for text, _ in rest.lengths[:2]] == [
        f"chamber {wound.actuator.length:g} mm",
        f"{whole:g} mm",
    ]


# --- in motion -------------------------------------------------------------------------------


def frames_of(file: IO[bytes]) -> int:
    from PIL import Image

    gif: Any
    with Image.open(file) as gif:
        return int(gif.n_frames)


def test_animation_has_a_frame_for_every_state(renderer: Renderer) -> None:
    from PIL import Image

    scene = model_mesh()
    states = [snapshot(scene, angle) for angle in (0.0, 30.0, 60.0, 90.0)]
    file = io.BytesIO()
    Animation(scene, renderer, ROOF).write(file, frames(scene, states), lambda: states)
    assert file.getbuffer().nbytes < 4_000_000
    gif: Any
    with Image.open(file) as gif:
        assert (gif.size, gif.n_frames, gif.info["loop"]) == (SIZE, 4, 0)
        pages = []
        for number in range(4):
            gif.seek(number)
            pages.append(np.asarray(gif.convert("RGB")).astype(int))
    # the colour bar, the axes and the scale stay as they are
    below = [page[SIZE[1] - 100 :] for page in pages]
    assert all((each == below[0]).all() for each in below)
    # the root stays where it is, and the tip goes down
    assert all((page != pages[0]).any() for page in pages[1:])
    lowest = [np.nonzero(np.ptp(page[:560], axis=2) > 60)[0].max() for page in pages]
    assert lowest == sorted(lowest)
    assert lowest[-1] > lowest[0] + 20
    with pytest.raises(ValueError, match="no state"):
        Animation(scene, renderer).write(io.BytesIO(), iter(()), lambda: [])


def test_pictures_with_obstacles(renderer: Renderer) -> None:
    scene = model_mesh()
    states = [snapshot(scene, angle) for angle in (30.0, 90.0)]
    beside = dataclasses.replace(
        ROOF, forces={state.step: {"roof": (0, -1, 0)} for state in states}
    )
    sizes: dict[str, int] = {}

    def write(name: str, fill: Any) -> None:
        file = io.BytesIO()
        fill(file)
        sizes[name] = file.getbuffer().nbytes

    names = draw_pictures(scene, states, write, renderer, scenery=beside)
    assert names == list(sizes)
    assert min(sizes.values()) > 15_000


# --- from the run to its pictures --------------------------------------------------------------


@pytest.mark.long
def test_a_run_marks_the_states_beyond_its_touch(tmp_path: Path) -> None:
    spread = WINDING["winding"] | {"as": "smeared"}
    bent = case(
        effects=[{"pressure": {"angle": "345 deg"}}, {"winding": spread}],
        model="section",
        mesh={},
        output={"at_angles": ["200 deg", "345 deg"], "animation": True, "fields": False},
    )
    run = run_case(bent, tmp_path / "run")
    rows = read_history(tmp_path / "run" / "history.csv")
    states = States(tmp_path / "run", bent, rows)
    remarks = {
        kept.angle_deg: state.remark for kept, state in zip(states.kept, states, strict=True)
    }
    (warning,) = [line for line in run.run["warnings"] if "passes through itself" in line]
    begin = float(warning.split("°")[0].removeprefix("from "))
    assert 200 < begin < 345
    for angle, remark in remarks.items():
        assert remark.startswith("passes through itself from" if angle > begin else "")
        assert bool(remark) == (angle > begin)
    with (tmp_path / "run" / "pictures" / "animation.gif").open("rb") as file:
        assert frames_of(file) == len(rows)
    assert (tmp_path / "run" / "pictures" / "rest.png").exists()


def test_a_body_that_is_bent_back_no_longer_passes_through_itself() -> None:
    touched = Report(self_contact={"control": math.radians(300.0)})
    assert on_state(Report(), None, 350.0) == ""
    assert on_state(touched, None, 299.0) == ""
    assert on_state(touched, None, 301.0) == "passes through itself from 300° on: not modelled"
    back = Report(self_contact={"control": -math.radians(300.0)})
    assert on_state(back, None, -301.0).startswith("passes through itself from −300°")
    assert on_state(back, None, 301.0) == ""
    walls = {"control": math.radians(-20.0)}
    text = "chamber walls pass through each other from −20° on: not modelled"
    assert on_state(touched, walls, 0.0) == text


def test_a_run_without_a_step_has_its_frame_at_rest(tmp_path: Path) -> None:
    said: list[str] = []
    shown = case(mesh={"axial": "6 mm"}, output={"pictures": True, "fields": False})
    draw(RunFolder(tmp_path), shown, model_mesh(), [], [], "no step", said.append)
    assert [path.name for path in (tmp_path / "pictures").iterdir()] == ["rest.png"]
    assert not said

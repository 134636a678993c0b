"""Pictures of a hand: fingers as their sections swept along their lines, and what they grasp."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fiberbend.drawing.page import any_sign, own_style, save
from fiberbend.drawing.renderer import FROM_THE_SIDE, Drawable, Image, Renderer, View, frame
from fiberbend.drawing.space.animation import SIZE as FRAME
from fiberbend.drawing.space.animation import save_gif
from fiberbend.drawing.space.page import Page
from fiberbend.drawing.style import Style
from fiberbend.hand.assembled import Assembled, Digit
from fiberbend.hand.rows import PRESSURE, on_object
from fiberbend.hand.solved import Moment
from fiberbend.states.labels import short_number
from rod.functions import Floats
from rod.shape import Shape

if TYPE_CHECKING:
    from fiberbend.states.snapshot import Target

COLORS = ("#d98c5f", "#5f9ed9", "#7fb069", "#b58bc9", "#e0b94f", "#6fc3bd")
"""Of the fingers in turn."""
OBJECT = "#c9c9c9"
SIDES = {
    "from the side": FROM_THE_SIDE,
    "from the front": (0.0, 0.0, 1.0),
    "from above": (0.0, 1.0, 1e-3),
    "obliquely": (-0.7, 0.45, 0.6),
}
_OBLIQUE = SIDES["obliquely"]
_STATES = 4
_WIDTH = 1400
_IMAGE = (760, 640)
_STATIONS = 120
_FINE = 0.5
"""Greatest distance of points around a section, mm."""
_MARGIN = 0.04
_CURVES = Style(width=280.0, height=105.0, font_size=11.0)
_BAND = 470
_WIDEST, _THINNER = 6.0, 0.8
"""Lines of the first finger, and by how much those of the next one of six are thinner."""


class HandPictures:
    """All pictures of a hand.

    Args:
        hand: the hand.
        moments: its states, the first at rest.
        rows: of history.csv.
        renderer: draws.
    """

    def __init__(
        self,
        hand: Assembled,
        moments: Sequence[Moment],
        rows: Sequence[dict[str, Any]],
        renderer: Renderer,
    ) -> None:
        self._hand, self._moments, self._rows, self._renderer = hand, moments, rows, renderer
        self._skins = [_Sweep(digit) for digit in hand.digits]
        every = [self._points(moment) for moment in (moments[0], moments[-1])]
        around = np.concatenate(every)
        self._objects = [item.surface(around) for item in hand.hand.objects.values()]
        shown = [around, *(np.asarray(solid.points) for solid in self._objects)]
        self._shown = np.concatenate(shown)

    def views(self, target: Target) -> None:
        """The last state from four sides."""
        images, views = [], []
        for toward in SIDES.values():
            view = self._view(toward, _IMAGE)
            views.append(view)
            images.append(self._image(self._moments[-1], view, _IMAGE))
        last = self._caption(len(self._moments) - 1)
        captions = [f"{name}\n{last}" for name in SIDES]
        page = Page.of_panels(_WIDTH, self._hand.hand.title, images, captions, views)
        self._legend(page)
        page.save(target)

    def states(self, target: Target) -> None:
        """From rest to the end."""
        last = len(self._moments) - 1
        chosen = sorted({round(part * last / (_STATES - 1)) for part in range(_STATES)})
        view = self._view(_OBLIQUE, _IMAGE)
        images = [self._image(self._moments[number], view, _IMAGE) for number in chosen]
        captions = [self._caption(number) for number in chosen]
        page = Page.of_panels(_WIDTH, self._hand.hand.title, images, captions, [view] * len(chosen))
        self._legend(page)
        page.save(target)

    def animation(self, target: Target) -> None:
        """All states, obliquely."""
        size = (FRAME[0], _BAND)
        view = self._view(_OBLIQUE, size)
        page = Page(FRAME, self._hand.hand.title)
        blank = np.full((_BAND, FRAME[0], 3), 255, dtype=np.uint8)
        box = (0.0, 112 / FRAME[1], 1.0, _BAND / FRAME[1])
        page.scale(page.image(blank, box, view), 14)
        self._legend(page)

        def frames() -> Iterator[Image]:
            for number, moment in enumerate(self._moments):
                caption = self._caption(number).replace("\n", ",  ")
                page.renew(self._image(moment, view, size), caption, "")
                yield page.pixels()

        # the last frame has the colours of all
        pages = list(frames())
        save_gif(target, pages, len(pages))

    def _legend(self, page: Page) -> None:
        names = [digit.finger.name for digit in self._hand.digits]
        colors = {name: COLORS[n % len(COLORS)] for n, name in enumerate(names)}
        page.legend(names, colors=colors)

    def _caption(self, number: int) -> str:
        """Pressure of a state, and how hard its fingers press on the objects."""
        row = self._rows[number]
        if number == 0:
            return "at rest"
        lines = [f"P = {short_number(row[PRESSURE])} kPa"]
        for name in self._hand.hand.objects:
            forces = [
                float(np.linalg.norm(on_object(row, place, name)))
                for place in range(len(self._hand.digits))
            ]
            low, high = (short_number(force) for force in (min(forces), max(forces)))
            size = low if low == high else f"{low} to {high}"
            lines.append(f"{size} N of a finger on the {name}")
        return "\n".join(lines)

    def _points(self, moment: Moment) -> Floats:
        parts = zip(self._skins, moment.state.shape.each, strict=True)
        return np.concatenate([skin.points(shape).reshape(-1, 3) for skin, shape in parts])

    def _view(self, toward: tuple[float, float, float], size: tuple[int, int]) -> View:
        return frame(self._shown, toward, size[0] / size[1], _MARGIN)

    def _image(self, moment: Moment, view: View, size: tuple[int, int]) -> Image:
        parts = zip(self._skins, moment.state.shape.each, strict=True)
        layers = [
            Drawable(skin.surface(shape), color=COLORS[number % len(COLORS)])
            for number, (skin, shape) in enumerate(parts)
        ]
        layers += [Drawable(solid, color=OBJECT) for solid in self._objects]
        return self._renderer.draw(layers, view, size)


class _Sweep:
    """The outer surface of a finger.

    Args:
        digit: the finger.
    """

    def __init__(self, digit: Digit) -> None:
        height = float(digit.slender.rod.layout.place[1])
        self._ring = np.array(digit.slender.site.actuator.outer_outline(_FINE)) - [0.0, height]
        total = float(digit.rod.layout.lengths.sum())
        self._reach = np.linspace(0.0, total, _STATIONS)

    def points(self, shape: Shape) -> Floats:
        """Of all stations, (s, k, 3), mm."""
        frames = shape.along(self._reach)
        flat = np.einsum("sij,kj->ski", frames[..., :2], self._ring)
        out: Floats = frames[:, None, :, 3] + flat
        return out

    def surface(self, shape: Shape) -> Any:
        """As a pyvista.PolyData, closed at both ends."""
        import pyvista as pv

        points = self.points(shape)
        count, around = points.shape[:2]
        here = np.arange(count - 1)[:, None] * around + np.arange(around)
        beside = np.roll(here, -1, axis=1)
        quads = np.stack([here, beside, beside + around, here + around], axis=-1).reshape(-1, 4)
        faces = np.column_stack([np.full(len(quads), 4), quads]).ravel()
        root = np.concatenate([[around], np.arange(around)[::-1]])
        tip = np.concatenate([[around], (count - 1) * around + np.arange(around)])
        # ends keep their edges: their corners are points of their own
        sides = pv.PolyData(points.reshape(-1, 3), faces=faces)
        ends = pv.PolyData(points.reshape(-1, 3), faces=np.concatenate([root, tip]))
        return sides.merge(ends, merge_points=False).triangulate()


def draw_curves(
    hand: Assembled, rows: Sequence[dict[str, Any]], target: Target, style: Style = _CURVES
) -> None:
    """Angles, forces on objects and distances over the pressure.

    Args:
        hand: the hand.
        rows: of history.csv.
        target: a path, or a file open for writing bytes.
        style: of the page.
    """
    pressure = [row[PRESSURE] for row in rows]
    with own_style(), any_sign():
        page = style.figure()
        panels = page.subplots(1, 3, gridspec_kw={"wspace": 0.3})
        titles = ("bending angle (°)", "force of each finger on the objects (N)", "gap (mm)")
        for axes, title in zip(panels, titles, strict=True):
            axes.set_title(title, fontsize=style.font_size, loc="left")
            axes.set_xlabel("pressure (kPa)", fontsize=style.font_size)
            axes.tick_params(labelsize=0.9 * style.font_size)
            axes.grid(alpha=0.25)
        for number, digit in enumerate(hand.digits):
            mine, color = f"finger_{number + 1}", COLORS[number % len(COLORS)]
            # fingers that do the same are seen beside each other
            look = {"color": color, "lw": _WIDEST - _THINNER * number * 6 / len(hand.digits)}
            angles = [row[f"{mine}_angle_deg"] for row in rows]
            panels[0].plot(pressure, angles, label=digit.finger.name, **look)
            for name in hand.hand.objects:
                forces = [float(np.linalg.norm(on_object(row, number, name))) for row in rows]
                panels[1].plot(pressure, forces, **look)
                gaps = [row[f"{mine}_{name}_gap_mm"] for row in rows]
                panels[2].plot(pressure, gaps, **look)
        page.legend(
            *panels[0].get_legend_handles_labels(),
            loc="lower center",
            ncols=len(hand.digits),
            frameon=False,
            fontsize=0.9 * style.font_size,
        )
        page.suptitle(hand.hand.title, fontsize=1.1 * style.font_size)
        page.subplots_adjust(left=0.06, right=0.98, top=0.86, bottom=0.26)
        save(page, target, style)

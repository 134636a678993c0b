"""Figure of a control run, after Fig. 13 of Polygerinos et al. 2015: steps left, sine right."""

from __future__ import annotations

import textwrap
from typing import Any

import numpy as np

from analytic.control.controller import Valves
from analytic.control.loop import Trace
from analytic.stress import Floats
from fiberbend.control.export import shown_time
from fiberbend.control.result import ControlResult
from fiberbend.drawing.page import figure, literal, save
from fiberbend.states.snapshot import Target

SIZE = (1500, 900)
"""Width and height in pixels."""
_BLUE, _RED, _GREEN, _GRAY = "#1f5a99", "#c0392b", "#3c8d40", "#555555"
_FILL, _VENT = "#5b9bd5", "#e6842a"
_ROWS = ((0.435, 0.445), (0.205, 0.19), (0.075, 0.09))
"""Bottom and height of angles, errors and valves on the page."""


def plot_control(result: ControlResult, target: Target, title: str = "") -> None:
    """Draw angles, angle error with its dead zone, and valves, over one step cycle and the sine.

    Args:
        result: what a control run has found.
        target: a path, or a file open for writing bytes.
        title: title of the case.
    """
    page = figure(SIZE)
    shown = textwrap.shorten(title, 90, placeholder=" …")
    page.text(0.5, 0.965, literal(shown), ha="center", va="center", fontsize=16)
    step, sine, settings = result.step_metrics, result.sine_metrics, result.settings
    hold = settings.steps.hold
    times = f"filling {shown_time(step.fill_s)}, emptying {shown_time(step.vent_s)}"
    delay = f"{settings.sine.frequency:g} Hz: delay {shown_time(sine.delay_s)}"
    columns = (
        (0.065, result.steps, (0.7 * hold, 2.7 * hold), f"(a)  steps: {times}", step.undesired),
        (
            0.555,
            result.sine,
            (0.0, settings.sine.duration),
            f"(b)  sine of {delay}",
            sine.undesired,
        ),
    )
    for left, trace, window, name, undesired in columns:
        _column(page, left, trace, window)
        text = f"{name}, undesired switching {100 * undesired:.2g} %"
        page.text(left, 0.906, text, ha="left", va="center", fontsize=13)
    handles, labels = page.axes[0].get_legend_handles_labels()
    page.axes[0].legend(handles, labels, loc="upper right", fontsize=11, framealpha=0.9)
    save(page, target)


def _column(page: Any, left: float, trace: Trace, window: tuple[float, float]) -> None:
    part = (trace.time >= window[0] - 1e-9) & (trace.time <= window[1] + 1e-9)
    time = trace.time[part]
    desired, filtered, angle, error, half = (
        np.degrees(values[part])
        for values in (trace.desired, trace.filtered, trace.angle, trace.error, trace.half)
    )
    angles, errors, valves = (page.add_axes((left, low, 0.425, tall)) for low, tall in _ROWS)
    angles.step(time, desired, where="post", color="black", linewidth=1.6, label="desired θ$_d$")
    angles.fill_between(
        time, desired - half, desired + half, step="post", color="0.88", label="dead zone"
    )
    angles.plot(time, angle, color=_GREEN, linewidth=1.8, label="plant θ")
    angles.plot(time, filtered, color=_BLUE, linewidth=1.8, label="filtered θ$_a$")
    angles.set_ylabel("bending angle (°)", fontsize=13)
    errors.fill_between(time, -half, half, step="post", color="0.88")
    errors.plot(time, error, color=_RED, linewidth=1.4)
    errors.axhline(0, color=_GRAY, linewidth=0.8)
    errors.set_ylabel("error θ$_e$ (°)", fontsize=13)
    most = 3.2 * float(half.max())
    errors.set_ylim(-most, most)
    _strip(valves, time, trace.valves[part])
    valves.set_xlabel("time (s)", fontsize=13)
    for axes in (angles, errors, valves):
        axes.set_xlim(*window)
        axes.tick_params(labelsize=11, labelbottom=axes is valves)
        axes.grid(color="0.92")
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)


def _strip(axes: Any, time: Floats, valves: Any) -> None:
    """Fill above the line, vent below it."""
    for command, color in ((Valves.FILL, _FILL), (Valves.VENT, _VENT)):
        height = np.where(valves == command, float(command), 0.0)
        axes.fill_between(time, 0, height, step="post", color=color, linewidth=0)
    axes.axhline(0, color=_GRAY, linewidth=0.8)
    axes.set_ylim(-1.25, 1.25)
    axes.set_yticks([-1, 0, 1], ["vent", "hold", "fill"])

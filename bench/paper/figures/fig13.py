"""Fig. 13: the feedback loop's step response and sine, simulated."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from analytic.control.filter import AngleFilter
from analytic.control.loop import Reference, Sensor, Trace, simulate
from analytic.control.metrics import SineMetrics, StepMetrics, sine_metrics, step_metrics
from analytic.control.plant import ActuatorCurve, ArcCurve, Plant
from bench.paper.facts import BASELINE, STATED
from bench.paper.lines import BLUE, GRAY, GREEN, RED, empty_page, legend, named
from bench.paper.part import Figure, Found, Table
from bench.paper.runs import ROOT, Runs
from bench.paper.verdict import Verdict, unknown, used, within
from fiberbend.control.command import fit_filter
from fiberbend.control.settings import ControlSettings, read_settings
from fiberbend.reader.reader import read_case
from geometry.mesh.data import Floats

NOISES = tuple(np.round(np.arange(0.0, 1.51, 0.25), 2).tolist())
"""Standard deviations of the pressure sensor that are tried, kPa."""
SEEDS = range(6)
PERIOD = "a period of the controller's 100 Hz"
COMMAND = "fiberbend control cases/free_bending.yaml"


@dataclasses.dataclass(frozen=True)
class Loop:
    """A loop with the plant of a case.

    Attributes:
        settings: of plant, filter and controller.
        curve: P, θ and V of the plant.
        filter: of the controller.
    """

    settings: ControlSettings
    curve: ActuatorCurve
    filter: AngleFilter

    @classmethod
    def of(cls, runs: Runs) -> Loop:
        """The baseline as the section model bends it, everything else by default."""
        settings = read_settings({})
        done = runs.section.sizes[BASELINE]
        volume = done.column("chamber_mm3")
        curve = ArcCurve(1e-3 * done.pressure, np.radians(done.angle), volume)
        case = read_case(ROOT / "cases" / "free_bending.yaml")
        return cls(settings, curve, fit_filter(case, curve, settings).filter)

    def steps(self, noise: float, seed: int = 0) -> tuple[Trace, StepMetrics]:
        """The steps with a noise in kPa, and what is measured of them."""
        trace = self._simulate(self.settings.steps, noise, seed)
        return trace, step_metrics(trace, self.settings.steps)

    def sine(self, noise: float, seed: int = 0) -> tuple[Trace, SineMetrics]:
        """The same of the sine."""
        trace = self._simulate(self.settings.sine, noise, seed)
        return trace, sine_metrics(trace, self.settings.sine)

    def _simulate(self, reference: Reference, noise: float, seed: int) -> Trace:
        plant = Plant(self.curve, self.settings.pneumatics)
        sensor = Sensor(1e-3 * noise, seed)
        return simulate(plant, self.filter, self.settings.controller, reference, sensor)


@dataclasses.dataclass(frozen=True)
class Noisy:
    """What the noise of the sensor does to undesired switching, a part of the time.

    Attributes:
        steps: of the steps by noise and seed, (n, s).
        fitted: the noise in kPa that gives the stated switching of the steps.
        sine: of the sine at that noise by seed, (s,).
    """

    steps: Floats
    fitted: float
    sine: Floats

    @classmethod
    def of(cls, loop: Loop) -> Noisy:
        """Steps at all noises and the sine at the fitted one, each with several seeds."""
        steps = np.array([[loop.steps(n, s)[1].undesired for s in SEEDS] for n in NOISES])
        mean = np.maximum.accumulate(steps.mean(axis=1))
        fitted = float(np.interp(STATED["switching"].value, mean, NOISES))
        return cls(steps, fitted, np.array([loop.sine(fitted, s)[1].undesired for s in SEEDS]))


def found(runs: Runs) -> Found:
    """Both traces and the five numbers."""
    loop = Loop.of(runs)
    noisy = Noisy.of(loop)
    noise = noisy.fitted
    rows = [
        [f"{value:g} kPa", f"{100 * a.mean():.2f}", f"{100 * a.std(ddof=1):.2f}"]
        for value, a in zip(NOISES, noisy.steps, strict=True)
    ]
    head = ("noise of the sensor", "mean", "scatter")
    words = (
        "The loop: the angle filter inverts (19), two valves switch at 100 Hz outside the dead "
        "zone (22), and the air in the chamber of the section model follows. The paper states "
        "neither supply, valves, tube, noise, nor the size of its steps and of its sine.",
        "Two unknowns are fitted, each to one number, and judge the others: the conductance of the "
        "valves to 91 ms, the noise of the sensor to 0.85 %. The rest is the default of "
        "fiberbend control.",
    )
    return Found(
        words=words,
        figures=[
            Figure(
                "fig13",
                _draw(loop, noise),
                f"(a) Steps between 150 and 210°, (b) sine of 0.2 Hz; noise {noise:.2f} kPa.",
            )
        ],
        tables=[
            Table(
                f"Undesired switching of the steps, % of the time, {len(SEEDS)} seeds", head, rows
            )
        ],
        verdicts=verdicts(loop, noisy),
        commands=[f'{COMMAND} --noise "{noise:.2f} kPa"'],
    )


def verdicts(loop: Loop, noisy: Noisy) -> list[Verdict]:
    """On what section VI states."""
    settings = loop.settings
    controller, where = settings.controller, "the loop"
    noise, step, sine = noisy.fitted, loop.steps(0.0)[1], loop.sine(0.0)[1]
    mean, scatter = float(noisy.sine.mean()), 2 * float(noisy.sine.std(ddof=1))
    stated = STATED["switching_sine"].value
    source = f"twice its scatter over {len(SEEDS)} seeds at the fitted noise of {noise:.2f} kPa"
    return [
        used("rate", controller.rate, where),
        used("divisor", controller.zone.divisor, where),
        used("offset", controller.zone.offset, where),
        used("sine", settings.sine.frequency, where),
        unknown(
            "fill",
            where,
            f"{1e3 * step.fill_s:.0f} ms",
            "the conductance of the valves, which is not stated, was fitted to it",
        ),
        within("vent", where, 1e3 * step.vent_s, 1e3 / controller.rate, PERIOD),
        within("delay", where, 1e3 * sine.delay_s, 1e3 / controller.rate, PERIOD),
        unknown(
            "switching",
            where,
            f"0 without noise, 0.85 % at {noise:.2f} kPa",
            "the noise of the sensor, which is not stated, was fitted to it",
        ),
        Verdict(
            STATED["switching_sine"],
            where,
            f"{100 * mean:.2f} %",
            bool(abs(mean - stated) <= scatter),
            f"{100 * (mean - stated):+.2f} %, bound ±{100 * scatter:.2f} %, {source}".replace(
                "-", "−"
            ),
        ),
    ]


def _draw(loop: Loop, noise: float) -> Any:
    figure = empty_page(6.2)
    grid = figure.add_gridspec(3, 2, height_ratios=(3, 1.4, 0.7))
    hold = loop.settings.steps.hold
    windows = ((0.7 * hold, 2.7 * hold), (0.0, loop.settings.sine.duration))
    titles = ("(a) steps", "(b) sine")
    for column, (trace, window, title) in enumerate(
        zip((loop.steps(noise)[0], loop.sine(noise)[0]), windows, titles, strict=True)
    ):
        panels = [figure.add_subplot(grid[row, column]) for row in range(3)]
        _column(panels, trace, window)
        named(panels[0], "", "angle, °" if column == 0 else "", title)
        named(panels[1], "", "error, °" if column == 0 else "")
        named(panels[2], "time, s", "valve" if column == 0 else "")
    legend(figure, figure.axes[0], 3, 0.35)
    return figure


def _column(panels: Sequence[Any], trace: Trace, window: tuple[float, float]) -> None:
    """Angles, error with the dead zone, and valves over a time."""
    part = (trace.time >= window[0] - 1e-9) & (trace.time <= window[1] + 1e-9)
    time = trace.time[part]
    desired, filtered, angle, error, half = (
        np.degrees(values[part])
        for values in (trace.desired, trace.filtered, trace.angle, trace.error, trace.half)
    )
    angles, errors, valves = panels
    angles.step(time, desired, where="post", color="black", lw=1.5, label="desired θ$_d$")
    angles.plot(time, filtered, color=BLUE, lw=1.5, label="filter θ$_a$")
    angles.plot(time, angle, color=GREEN, lw=1.5, ls="--", label="plant θ")
    errors.fill_between(time, -half, half, step="post", color="0.87")
    errors.plot(time, error, color=RED, lw=1.3)
    most = 3.2 * float(half.max())
    errors.set_ylim(-most, most)
    valves.step(time, trace.valves[part], where="post", color=GRAY, lw=1.2)
    valves.set_yticks((-1, 0, 1), ("vent", "hold", "fill"))
    for panel in panels:
        panel.grid(color="0.9", linewidth=0.8)
        panel.set_axisbelow(True)
        panel.tick_params(labelsize=10.5)
        panel.spines[["top", "right"]].set_visible(False)
        panel.set_xlim(*window)
    for panel in panels[:2]:
        panel.tick_params(labelbottom=False)

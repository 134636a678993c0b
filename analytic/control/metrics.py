"""How well a loop follows, by the paper's three measures. s, rad.

Section VI of Polygerinos et al. 2015 (doi 10.1109/TRO.2015.2428504): 'For both signal forms, the
time delay for the system to track the desired angle signal θ_d and the unintended switching of the
valves were evaluated'; 'the actuator angle was able to follow the reference signal with an average
convergence time of 91 ms and with an undesired valve switching of 0.85% of the total time'; 'a
tracking delay of 60 ms and an undesired valve switching of 0.5% of the total time'. It defines none
of them further. Here, of the filtered angle θ_a that the paper plots:

* convergence time: from a step of θ_d to the moment at which θ_e enters the dead zone, straight
  between the samples; mean of the steps up (filling) and down (emptying).
* tracking delay: the shift in time by which θ_d comes closest to θ_a in the mean square over all
  periods but the first.
* undesired switching: samples at which a valve is open although the reference does not ask for it,
  as a part of all. After a step: the wrong valve at any time, either valve once θ_e has been in the
  zone. Under the sine: the outlet while θ_d rises, the inlet while it falls.
"""

from __future__ import annotations

import dataclasses
import itertools
import math

import numpy as np
from numpy.typing import NDArray

from analytic.control.controller import Valves
from analytic.control.loop import Sine, Steps, Trace
from analytic.stress import Floats

PAPER = {
    "fill_s": 0.091,
    "vent_s": 0.124,
    "undesired_steps": 0.0085,
    "delay_s": 0.060,
    "undesired_sine": 0.005,
}
"""What the paper measured, section VI."""


@dataclasses.dataclass(frozen=True)
class StepMetrics:
    """Step response.

    Attributes:
        fill_s: mean convergence time of the steps up, s; nan where a step did not converge.
        vent_s: the same of the steps down.
        undesired: part of all samples with a valve open undesired.
        openings: number of times that a valve opened, in all.
        error_rad: greatest |θ − θ_d| of the plant itself at the ends of the holds.
    """

    fill_s: float
    vent_s: float
    undesired: float
    openings: int
    error_rad: float


@dataclasses.dataclass(frozen=True)
class SineMetrics:
    """Tracking of a sine.

    Attributes:
        delay_s: tracking delay of the filtered angle, s.
        plant_delay_s: the same of the plant's angle.
        undesired: part of all samples with a valve open undesired.
        openings: number of times that a valve opened, in all.
        error_rad: root mean square of θ_e after the first period.
        plant_error_rad: the same of θ_d less the plant's angle.
    """

    delay_s: float
    plant_delay_s: float
    undesired: float
    openings: int
    error_rad: float
    plant_error_rad: float


def step_metrics(trace: Trace, steps: Steps) -> StepMetrics:
    """Measure a step response."""
    inside = np.abs(trace.error) <= trace.half
    undesired = 0
    times: dict[Valves, list[float]] = {Valves.FILL: [], Valves.VENT: []}
    ends = []
    bounds = [0.0, *steps.times, steps.duration]
    for i, (start, stop) in enumerate(itertools.pairwise(bounds)):
        first, last = (int(np.searchsorted(trace.time, t - 1e-9)) for t in (start, stop))
        valves = trace.valves[first:last]
        if i == 0:
            undesired += int(np.count_nonzero(valves))
            continue
        right = Valves.FILL if i % 2 else Valves.VENT
        entered = _first(inside[first:last])
        times[right].append(_entry(trace, first, entered) - start)
        undesired += int(np.count_nonzero(valves[:entered] == -right))
        undesired += int(np.count_nonzero(valves[entered:]))
        ends.append(abs(trace.angle[last - 1] - trace.desired[last - 1]))
    return StepMetrics(
        fill_s=float(np.mean(times[Valves.FILL])),
        vent_s=float(np.mean(times[Valves.VENT])),
        undesired=undesired / len(trace.time),
        openings=_openings(trace.valves),
        error_rad=float(max(ends)),
    )


def sine_metrics(trace: Trace, sine: Sine) -> SineMetrics:
    """Measure the tracking of a sine."""
    change = np.sin(2 * math.pi * sine.frequency * trace.time)
    undesired = trace.valves * change < -1e-9
    kept = trace.time >= 1 / sine.frequency - 1e-9
    time = trace.time[kept]
    return SineMetrics(
        delay_s=_delay(time, trace.filtered[kept], sine.frequency),
        plant_delay_s=_delay(time, trace.angle[kept], sine.frequency),
        undesired=float(np.mean(undesired)),
        openings=_openings(trace.valves),
        error_rad=_rms(trace.error[kept]),
        plant_error_rad=_rms((trace.desired - trace.angle)[kept]),
    )


def _first(inside: NDArray[np.bool_]) -> int:
    return int(np.argmax(inside)) if inside.any() else len(inside)


def _entry(trace: Trace, first: int, entered: int) -> float:
    """When θ_e crossed the edge of the zone before sample first + entered; nan if it never did."""
    i = first + entered
    if i >= len(trace.time) or abs(trace.error[i]) > trace.half[i]:
        return math.nan
    if entered == 0:
        return float(trace.time[i])
    # θ_d, and with it the zone, is the same at both samples
    before, after = (abs(trace.error[j]) - trace.half[j] for j in (i - 1, i))
    part = before / (before - after)
    return float(trace.time[i - 1] + part * (trace.time[i] - trace.time[i - 1]))


def _delay(time: Floats, angle: Floats, frequency: float) -> float:
    """Shift of −cos(2π f t) that is closest to a signal over whole periods: that of its phase."""
    turn = 2 * math.pi * frequency * time
    columns = np.column_stack([-np.cos(turn), np.sin(turn), np.ones_like(turn)])
    # −cos(ωt − φ) = −cos ωt cos φ − sin ωt sin φ
    cosine, sine, _ = np.linalg.lstsq(columns, angle, rcond=None)[0]
    return math.atan2(-sine, cosine) / (2 * math.pi * frequency)


def _openings(valves: NDArray[np.int8]) -> int:
    changed = np.diff(valves, prepend=np.int8(0)) != 0
    return int(np.count_nonzero(changed & (valves != 0)))


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))

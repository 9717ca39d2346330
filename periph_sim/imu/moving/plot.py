"""Plots of a moving experiment: attitudes and rates, as in Figures 5.6 and B.1 of the dissertation.

attitudes.svg has the true motion, the estimates from real sensors and corrected emulator, and their differences.
rates.svg has the rates of the real gyroscope, and of the emulated gyroscope as built and corrected.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..identification.plot import COLOURS, STYLE
from ..rotations import Floats, angles
from .experiment import MovingOutcome

DASHES = ("-", "--", "-.")
ANGLES = ("roll", "pitch", "yaw")
POINTS = 1200  # maximum number of points of a line; more points would not be visible and would make the file larger


def attitudes(outcome: MovingOutcome, path: Path) -> None:
    """Draw the true and the estimated attitudes, and the angles between them, as SVG.

    Equal input gives an equal file.
    """
    panels = [("truth", outcome.truth), ("real sensors", outcome.real.attitudes)]
    panels.append(("emulator", outcome.emulated["corrected"].attitudes))
    with rc_context(STYLE):
        figure, axes = _figure(len(panels) + 1)
        for panel, (title, found) in zip(axes, panels, strict=False):
            _lines(panel, outcome.seconds, np.degrees(angles(found)), ANGLES)
            panel.set(ylabel=f"{title}, degrees")
        _legend(axes[0])
        apart = outcome.apart()
        names = ("real sensors less truth", "emulator corrected less truth", "emulator corrected less real sensors")
        _lines(axes[-1], outcome.seconds, np.stack([apart[name].total for name in names], axis=1), names)
        axes[-1].set(ylabel="apart, degrees", xlabel="time, s")
        _legend(axes[-1])
        figure.savefig(path, metadata={"Date": None})


def rates(outcome: MovingOutcome, path: Path) -> None:
    """Draw the rates that the real and the emulated gyroscopes measured, as SVG. Equal input gives an equal file.

    The rates are those about the axes of the body, in deg/s, without biases.
    """
    imu = outcome.subject.sensors
    read = {"real": outcome.real.readings}
    read |= {rates: one.readings for rates, one in outcome.emulated.items()}
    with rc_context(STYLE):
        figure, axes = _figure(len(read))
        for panel, (name, readings) in zip(axes, read.items(), strict=True):
            _lines(panel, readings.seconds, readings.samples(imu).gyro, ("p", "q", "r"))
            panel.set(ylabel=f"{name}, deg/s")
        _legend(axes[0])
        axes[-1].set(xlabel="time, s")
        figure.savefig(path, metadata={"Date": None})


def _figure(panels: int) -> tuple[Figure, Sequence[Axes]]:
    figure = Figure(figsize=(7.5, 1.9 * panels), layout="constrained")
    axes = figure.subplots(panels, 1, sharex=True)
    for panel in axes:
        panel.grid(True, color="#dddddd")
    return figure, axes


def _legend(panel: Axes) -> None:
    """Place the legend above the panel, where it hides no line."""
    panel.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, frameon=False)


def _lines(panel: Axes, seconds: Floats, columns: Floats, names: Sequence[str]) -> None:
    step = max(1, -(-len(seconds) // POINTS))
    for column, name, colour, dash in zip(columns.T, names, COLOURS[:3], DASHES, strict=True):
        panel.plot(seconds[::step], column[::step], dash, color=colour, linewidth=1.1, label=name)

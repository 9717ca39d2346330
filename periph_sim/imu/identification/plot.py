"""The Allan plot: a log-log picture of identified axes with error bars and fitted lines, as a file.

There is one panel per unit. The error bar of each point contains the true deviation with a probability of 68 %. The
line of slope -1/2 is thick where it was fitted and thin where it is extended to 1 s. A ring marks the value of this
line at 1 s; the square of this value is the density. If white noise is nowhere most of the noise, there is neither line
nor ring. A dashed line is the sum of all terms, if the slow terms were fitted.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .confidence import LEVELS, edf, interval
from .identify import Identified
from .noise_terms import FLOOR, READ_AT

# People with colour blindness can distinguish these colours.
COLOURS = ("#0060a8", "#c04a00", "#3a7d34", "#7a3b9a", "#777777")
MARKS = "osd^v"
STYLE: dict[Any, Any] = {"svg.hashsalt": "periph-sim", "svg.fonttype": "none", "font.size": 9.0, "axes.axisbelow": True}


def plot(title: str, axes: Sequence[Identified], path: Path) -> None:
    """Write a plot of Allan deviations over averaging times, with one panel per unit.

    title: the text above the panels.
    axes: the identified axes of sensors.
    path: the file, whose suffix selects SVG or PNG. Equal input gives an equal SVG file.
    """
    units = list(dict.fromkeys(axis.unit for axis in axes))
    with rc_context(STYLE):
        figure = Figure(figsize=(1.5 + 4.2 * len(units), 4.4))
        panels = figure.subplots(1, len(units), squeeze=False)
        for panel, unit in zip(panels[0], units, strict=True):
            for number, axis in enumerate(one for one in axes if one.unit == unit):
                _draw(panel, axis, COLOURS[number % len(COLOURS)], MARKS[number % len(MARKS)])
            panel.set(xscale="log", yscale="log", xlabel="averaging time, s", ylabel=f"Allan deviation, {unit}")
            panel.grid(True, which="major", color="#dddddd")
            panel.grid(True, which="minor", color="#f0f0f0")
            panel.axvline(READ_AT, color="#555555", linewidth=0.8, linestyle=":")
            panel.legend(loc="lower left", frameon=True, framealpha=0.9)
        figure.suptitle(title)
        figure.tight_layout()
        metadata = {"Date": None} if path.suffix.casefold() == ".svg" else {}
        figure.savefig(path, metadata=metadata, dpi=110)


def _draw(panel: Axes, axis: Identified, colour: str, mark: str) -> None:
    found, noise = axis.allan, axis.density
    low, high = interval(edf(found), LEVELS["68 %"])
    bars = np.abs(found.deviation * (np.sqrt(np.stack([low, high])) - 1))
    panel.errorbar(
        found.taus,
        found.deviation,
        yerr=bars,
        fmt=mark,
        color=colour,
        markersize=4,
        linewidth=1,
        capsize=2,
        label=axis.series.name,
    )
    fitted = found.taus[noise.region]
    if len(fitted):
        panel.plot(fitted, np.sqrt(noise.value / fitted), color=colour, linewidth=1.2)
        to_read = np.array([min(fitted[0], READ_AT), max(fitted[-1], READ_AT)])
        panel.plot(to_read, np.sqrt(noise.value / to_read), color=colour, linewidth=0.6)
        panel.plot([READ_AT], [np.sqrt(noise.value / READ_AT)], "o", markersize=9, markerfacecolor="none", color=colour)
    slow = axis.slow
    if slow is not None:
        whole = noise.value / found.taus
        whole = whole + FLOOR * slow.bias_instability.squared + slow.random_walk.squared * found.taus / 3
        panel.plot(found.taus, np.sqrt(whole), color=colour, linewidth=0.9, linestyle="--")

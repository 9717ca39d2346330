"""Identified parameters and errors as text and as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10

from ...core.text_table import paragraph, text_table
from .confidence import LEVELS
from .identify import Identified
from .noise_terms import Term

FOUND = ("column", "bias", "noise density", "sensor's own")
KNOWN = ("column", "95 % of the density", "rounding", "fitted from, to")


def table(title: str, axes: Sequence[Identified]) -> str:
    """Format a title, the parameters and errors of each column, the slow terms if they were fitted, and notes."""
    lines = [title, "", *text_table(FOUND, [_found(axis) for axis in axes])]
    lines += ["", *text_table(KNOWN, [_known(axis) for axis in axes])]
    lines += ["", "Densities in the column's unit, squared, per Hz. Errors are standard errors."]
    slow = [row for axis in axes for row in _slow(axis)]
    if slow:
        lines += ["", *text_table(("column", "slow term", "value", "95 % of it", ""), slow)]
    notes = [line for axis in axes for note in axis.notes for line in paragraph(f"note: {note}")]
    return "\n".join([*lines, *([""] if notes else []), *notes])


def as_json(axes: Sequence[Identified]) -> list[dict[str, object]]:
    """Return one object for each column, with numbers in the unit of the column and in seconds."""
    return [_object(axis) for axis in axes]


def with_error(value: float, error: float) -> str:
    """Format a value with its standard error, both rounded to the second significant digit of the error.

    If the error is 100 or more, both are rounded to a whole number. An error of 0 is left out.
    """
    if error <= 0:
        return f"{value:g}"
    decimals = max(1 - floor(log10(error)), 0)
    return f"{value:.{decimals}f} +/- {error:.{decimals}f}"


def scaled(value: float, error: float) -> str:
    """Format a value with its standard error and a common power of ten."""
    power = floor(log10(value)) if value > 0 else 0
    return f"({with_error(value / 10**power, error / 10**power)})e{power:+03d}"


def _found(axis: Identified) -> tuple[str, ...]:
    bias = f"{with_error(axis.bias.value, axis.bias.error)} {axis.unit}"
    density = scaled(axis.density.value, axis.density.error)
    return axis.series.name, bias, density, f"{axis.sensor_density:.3e}"


def _known(axis: Identified) -> tuple[str, ...]:
    """Return the four cells of a row of the table whose titles are in KNOWN.

    1. The name of the recording's column.
    2. The 95 % interval of the noise density.
    3. The density of the noise that rounding adds; "-" if the values are not quantized.
    4. The first and last tau of the fit; "-" if white noise is most of the noise at no tau.
    """
    low, high = axis.density.bounds(LEVELS["95 %"])
    taus = axis.allan.taus[axis.density.region]
    rounding = f"{axis.quantisation_density:.2e}" if axis.series.lsb is not None else "-"
    fitted = f"{taus[0]:g} s, {taus[-1]:g} s" if len(taus) else "-"
    return axis.series.name, f"{low:.3e} to {high:.3e}", rounding, fitted


def _slow(axis: Identified) -> list[tuple[str, ...]]:
    slow = axis.slow
    if slow is None:
        return []
    name = axis.series.name
    unit = f"({axis.unit})" if "/" in axis.unit else axis.unit
    return [
        (name, "bias instability", *_term(slow.bias_instability, axis.unit)),
        (name, "random walk", *_term(slow.random_walk, f"{unit}/s^0.5")),
    ]


def _term(term: Term, unit: str) -> tuple[str, str, str]:
    low, high = term.bounds(1.96)
    said = f"{term.value:.3g} {unit}" if term.found else "-"
    return said, f"{low:.2g} to {high:.2g} {unit}", "" if term.found else "not significant"


def _object(axis: Identified) -> dict[str, object]:
    noise, bias = axis.density, axis.bias
    row: dict[str, object] = {
        "column": axis.series.name,
        "unit": axis.unit,
        "samples": len(axis.series.samples),
        "period_s": axis.series.period,
        "lsb": axis.series.lsb,
        "bias": {
            "value": bias.value,
            "standard_error": bias.error,
            "of_white_noise": bias.white,
            "of_drift": bias.drift,
            "of_quantisation": bias.quantisation,
        },
        "noise_density": {
            "value": noise.value,
            "standard_error": noise.error,
            "edf": noise.edf,
            **{f"interval_{level}": noise.bounds(part) for level, part in LEVELS.items()},
            "read_at_1_s": noise.at_one_second,
            "of_rounding": axis.quantisation_density,
            "of_the_sensor": axis.sensor_density,
            "fitted_taus_s": axis.allan.taus[noise.region].tolist(),
        },
        "allan": {"tau_s": axis.allan.taus.tolist(), "deviation": axis.allan.deviation.tolist()},
        "notes": list(axis.notes),
    }
    if axis.slow is not None:
        for key, term in (("bias_instability", axis.slow.bias_instability), ("random_walk", axis.slow.random_walk)):
            row[key] = {"value": term.value, "interval_95 %": term.bounds(1.96), "told_from_0": term.found}
    return row

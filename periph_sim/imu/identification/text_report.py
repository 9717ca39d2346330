"""Identified parameters and errors as text and as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, log10

from ...core.text_table import paragraph, text_table
from .confidence import LEVELS
from .identify import Identified
from .noise_terms import Term

FOUND = ("column", "bias", "noise density", "sensor's own")
KNOWN = ("column", "95 % of the density", "rounding", "fitted from, to")


@dataclass(frozen=True, eq=False)
class IdentifiedAxis:
    """One column of a recording: its unit and its identified parameters."""

    unit: str
    found: Identified


def table(title: str, axes: Sequence[IdentifiedAxis]) -> str:
    """Format a title, the parameters and errors of each column, the slow terms if they were fitted, and notes."""
    lines = [title, "", *text_table(FOUND, [_found(axis) for axis in axes])]
    lines += ["", *text_table(KNOWN, [_known(axis) for axis in axes])]
    lines += ["", "Densities in the column's unit, squared, per Hz. Errors are standard errors."]
    slow = [row for axis in axes for row in _slow(axis)]
    if slow:
        lines += ["", *text_table(("column", "slow term", "value", "95 % of it", ""), slow)]
    notes = [line for axis in axes for note in axis.found.notes for line in paragraph(f"note: {note}")]
    return "\n".join([*lines, *([""] if notes else []), *notes])


def as_json(axes: Sequence[IdentifiedAxis]) -> list[dict[str, object]]:
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


def _found(axis: IdentifiedAxis) -> tuple[str, ...]:
    found = axis.found
    bias = f"{with_error(found.bias.value, found.bias.error)} {axis.unit}"
    density = scaled(found.density.value, found.density.error)
    return found.series.name, bias, density, f"{found.sensor_density:.3e}"


def _known(axis: IdentifiedAxis) -> tuple[str, ...]:
    """Return the cells of one row under KNOWN.

    They are the name of the recording's column, the 95 % interval of the noise density, the density of the noise that
    rounding adds, and the first and last tau of the fit, or "-" if white noise is nowhere most of the noise.
    """
    found = axis.found
    low, high = found.density.bounds(LEVELS["95 %"])
    taus = found.allan.taus[found.density.region]
    rounding = f"{found.quantisation_density:.2e}" if found.series.lsb is not None else "-"
    fitted = f"{taus[0]:g} s, {taus[-1]:g} s" if len(taus) else "-"
    return found.series.name, f"{low:.3e} to {high:.3e}", rounding, fitted


def _slow(axis: IdentifiedAxis) -> list[tuple[str, ...]]:
    slow = axis.found.slow
    if slow is None:
        return []
    name = axis.found.series.name
    unit = f"({axis.unit})" if "/" in axis.unit else axis.unit
    return [
        (name, "bias instability", *_term(slow.bias_instability, axis.unit)),
        (name, "random walk", *_term(slow.random_walk, f"{unit}/s^0.5")),
    ]


def _term(term: Term, unit: str) -> tuple[str, str, str]:
    low, high = term.bounds(1.96)
    said = f"{term.value:.3g} {unit}" if term.found else "-"
    return said, f"{low:.2g} to {high:.2g} {unit}", "" if term.found else "not significant"


def _object(axis: IdentifiedAxis) -> dict[str, object]:
    found, noise, bias = axis.found, axis.found.density, axis.found.bias
    row: dict[str, object] = {
        "column": found.series.name,
        "unit": axis.unit,
        "samples": len(found.series.samples),
        "period_s": found.series.period,
        "lsb": found.series.lsb,
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
            "of_rounding": found.quantisation_density,
            "of_the_sensor": found.sensor_density,
            "fitted_taus_s": found.allan.taus[noise.region].tolist(),
        },
        "allan": {"tau_s": found.allan.taus.tolist(), "deviation": found.allan.deviation.tolist()},
        "notes": list(found.notes),
    }
    if found.slow is not None:
        for key, term in (("bias_instability", found.slow.bias_instability), ("random_walk", found.slow.random_walk)):
            row[key] = {"value": term.value, "interval_95 %": term.bounds(1.96), "told_from_0": term.found}
    return row

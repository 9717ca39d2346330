"""Results of a moving experiment as text and as JSON."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...core.text_table import paragraph, text_table
from ..attitude import AttitudeErrors
from ..models.parameters import Rates
from ..rotations import Floats
from .experiment import Lag, MovingOutcome

AXES = ("roll", "pitch", "yaw", "total")


def rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


def lines(outcome: MovingOutcome) -> Iterator[str]:
    """Yield the lines of the report: tables of all comparisons, and the main results as sentences."""
    subject, count = outcome.subject, len(outcome.seconds)
    noise = "no noise" if subject.seed is None else f"noise of seed {subject.seed}"
    how = "computed without wires" if outcome.bytes is None else "over SCI, firmware and I2C"
    yield from paragraph(f"{subject.case.name}: {count} rounds; emulator in {subject.arithmetic}, {noise}, {how}")
    yield ""
    apart = {name: [getattr(one, axis) for axis in AXES] for name, one in outcome.apart().items()}
    roots = [(name, *(f"{rms(angles):.3f}" for angles in axes)) for name, axes in apart.items()]
    worst = [(name, *(f"{np.abs(angles).max():.2f}" for angles in axes)) for name, axes in apart.items()]
    yield from text_table(("root mean square, degrees", *AXES), roots, range(1, 5))
    yield ""
    yield from text_table(("worst, degrees", *AXES), worst, range(1, 5))
    yield ""
    for rates in outcome.emulated:
        yield from paragraph(_point(outcome, rates))
    if outcome.bytes is not None:
        equal = outcome.bytes.compared - outcome.bytes.different
        yield f"{equal} of {outcome.bytes.compared} bytes read from the emulator equal those computed without wires"


def _point(outcome: MovingOutcome, rates: Rates) -> str:
    """Return a sentence on the difference between emulator and real sensors.

    If the emulator's delay is not 0, the sentence also has the difference without this delay.
    """
    apart, late = outcome.apart(), outcome.behind(rates)
    between = rms(apart[f"emulator {rates} less real sensors"].total)
    said = f"{rates}: emulator and real sensors {between:.3f} degrees apart (rms)"
    if not late.seconds:
        return said
    return f"{said}; {rms(late.apart.total):.3f} with the real ones {late.seconds * 1000:.0f} ms earlier"


def as_json(outcome: MovingOutcome) -> dict[str, Any]:
    """Return the results as a dictionary with angles in degrees."""
    read = outcome.bytes
    return {
        "case": outcome.subject.case.name,
        "rounds": len(outcome.seconds),
        "arithmetic": outcome.subject.arithmetic,
        "noise_seed": outcome.subject.seed,
        "wires": read is not None,
        "bytes": None if read is None else {"compared": read.compared, "different": read.different},
        "behind": {rates: _behind(outcome.behind(rates)) for rates in outcome.emulated},
        "apart": {name: _numbers(one) for name, one in outcome.apart().items()},
    }


def _behind(late: Lag) -> dict[str, float]:
    left = late.apart.total
    return {"seconds": late.seconds, "rms_left": rms(left) if len(left) else 0.0}


def _numbers(apart: AttitudeErrors) -> dict[str, dict[str, float]]:
    found = {}
    for axis in AXES:
        values: Floats = getattr(apart, axis)
        found[axis] = {"rms": rms(values), "worst": float(np.abs(values).max())}
    return found

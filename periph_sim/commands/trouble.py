"""How a command says no: a mistake of the user's goes in, one sentence and exit status 2 come out."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import click

# Errors that the input is to blame for, by name: a command that cannot raise one need not import it.
MISTAKES = {
    "periph_sim.baselines.trouble.BadCheck",
    "periph_sim.bound.terms.BadBound",
    "periph_sim.case.model.BadCase",
    "periph_sim.core.kernel.SimulationStuck",
    "periph_sim.devices.attitude.NoAttitude",
    "periph_sim.devices.models.quantity.BadParameter",
    "periph_sim.devices.motion.BadMotion",
    "periph_sim.devices.noise.BadNoise",
    "periph_sim.extremes.NoSuchExtreme",
    "periph_sim.f28335.memory.NoSuchAddress",
    "periph_sim.formats.capture.BadCapture",
    "periph_sim.host.blame.FirmwareError",
    "periph_sim.identification.series.BadSeries",
    "periph_sim.insight.run.NotInRun",
    "periph_sim.numeric.named.NoSuchArithmetic",
    "periph_sim.numeric.q.DoesNotFit",
    "periph_sim.recording.BadRecording",
    "periph_sim.replay.BadReplay",
}


@contextmanager
def told_plainly() -> Iterator[None]:
    """Errors that the input is to blame for become one line on standard error and status 2."""
    try:
        yield
    except Exception as error:
        if MISTAKES.isdisjoint(f"{kind.__module__}.{kind.__qualname__}" for kind in type(error).__mro__):
            raise
        raise click.ClickException(str(error)) from None

"""Reporting of the user's errors by one sentence and exit status 2."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import click

# Errors caused by input, by name: a command that cannot raise one need not import it.
MISTAKES = {
    "periph_sim.interfaces.reports.baselines.files.BadCheck",
    "periph_sim.scene.case.model.BadCase",
    "periph_sim.core.input_error.InputError",
    "periph_sim.core.kernel.SimulationStuck",
    "periph_sim.core.time.TimeError",
    "periph_sim.core.wire.TooManyParties",
    "periph_sim.f28335.memory.memory_map.NoSuchAddress",
    "periph_sim.traces.capture.capture.BadCapture",
    "periph_sim.processor.error_origin.FirmwareError",
    "periph_sim.records.run.NotInRun",
    "periph_sim.records.recording.BadRecording",
    "periph_sim.replay.BadReplay",
    "periph_sim.outside.errors.OutsideError",
    "periph_sim.processor.image_files.model.BadImage",
}


@contextmanager
def running_user_code() -> Iterator[None]:
    """Apply `usage_errors_in_one_sentence`, and redirect user code's output to standard error."""
    from ...processor.user_code import output_aside

    with usage_errors_in_one_sentence(), output_aside():
        yield


@contextmanager
def usage_errors_in_one_sentence() -> Iterator[None]:
    """Turn errors caused by input into one line on standard error and status 2."""
    try:
        yield
    except Exception as error:
        if MISTAKES.isdisjoint(f"{kind.__module__}.{kind.__qualname__}" for kind in type(error).__mro__):
            raise
        raise click.ClickException(str(error)) from None

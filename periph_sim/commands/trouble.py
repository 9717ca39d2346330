"""How a command says no: a mistake of the user's goes in, one sentence and exit status 2 come out."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import click

from ..case.model import BadCase
from ..core.kernel import SimulationStuck
from ..f28335.memory import NoSuchAddress
from ..formats.capture import BadCapture
from ..host.cpu import FirmwareError
from ..recording import BadRecording
from ..replay import BadReplay


@contextmanager
def told_plainly() -> Iterator[None]:
    """Errors that the input is to blame for become one line on standard error and status 2."""
    try:
        yield
    except (BadCase, BadCapture, BadRecording, BadReplay, NoSuchAddress, FirmwareError, SimulationStuck) as error:
        raise click.ClickException(str(error)) from None

"""Small sessions for tests: shipped firmware in a case of few lines, whose only other party is outside."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from periph_sim.api import make_case
from periph_sim.core.records import RECORDED, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.outside.errors import OutsideError
from periph_sim.outside.session import Session
from periph_sim.scene.case.model import Case

FIRMWARE = Path(__file__).parents[2] / "firmware" / "python"
BUS = ("SDA", "SCL")


def case(firmware: str = "responder", modules: Sequence[str] = ("I2C-A",), dsp: Any = None, **more: Any) -> Case:
    """Return a case with shipped firmware; `dsp` has further keys of its unit."""
    unit = {"firmware": str(FIRMWARE / f"{firmware}.py"), "modules": list(modules), **(dsp or {})}
    return make_case(name="mine", duration="1 s", **({"unit": {"dsp": unit}} | more))


def begun(of: Case | Path, lines: Sequence[str] | None = BUS, **more: Any) -> Session:
    """Return a session at 1 ms, when the start-up of shipped firmware is over."""
    session = Session(of, lines, **more)
    session.advance(session.ticks("1 ms"))
    return session


def refuses(
    sentence: str, call: Callable[..., object], *arguments: Any, error: type[Exception] = OutsideError, **more: Any
) -> None:
    """Check that this call raises an error whose text matches `sentence`."""
    with pytest.raises(error, match=sentence):
        call(*arguments, **more)


def fails(code: int, call: Callable[..., object], *arguments: Any, match: str | None = None, **more: Any) -> None:
    """Check that this call raises an OSError with this code, whose text matches `match`."""
    with pytest.raises(OSError, match=match) as failed:
        call(*arguments, **more)
    assert failed.value.errno == code


class Records:
    """All records of a session; a test may count events in `events`."""

    def __init__(self) -> None:
        self.kept: list[Record] = []
        self.events = 0

    def subscribe(self, recorder: Recorder, _: Timebase) -> None:
        recorder.subscribe(RECORDED, self.kept.append)


def bus(**more: Any) -> tuple[Session, Records]:
    """Return a session of the responder (address 0x50, bytes 1, 2, 3 ...) on SDA and SCL after its start-up."""
    records = Records()
    return begun(case(), subscribe=records.subscribe, **more), records

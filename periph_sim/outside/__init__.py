"""Sessions: external code runs a case step by step, and pulls some lines of the case low or releases them.

A session itself reads no port and no network; `live` and `drivers` connect it to programs.

simulator, serial port, driver --apply--> Session --advance--> changes of the case's pins, with their ticks
                                             `--log--> replay --> the same run again

Terms of this package:

case: a simulated circuit of DSPs, chips and wires, as a file describes it. Its time is counted in ticks.
the outside: the code that uses a session.
party: a participant of a line, which drives or receives it: a module of a DSP, a device or the outside.
line that leads outside: a wire of the case that the outside may release or pull low.
move: a change of a line by the outside, at a tick.
client: a program that is connected to a session, for example by a serial port.
door: in `live`, a connection between a session and its clients.
step: in `live`, an advance of the session by a short simulated time. The doors transfer bytes between two steps.
SCI: a UART module of the DSP. RX and TX are its lines.
port: a serial port of the computer, real or simulated; in names such as "scia", an SCI of the case.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ..records.recording import Subscribe
from ..scene.case.load import load
from ..scene.case.model import Case
from ..scene.firmware_loader import Firmware
from ..scene.outside_log import BadLog, LogReader
from ..scene.result import Result
from .errors import OutsideError
from .session import Change, Session

__all__ = ["Change", "OutsideError", "Session", "replay"]


def replay(
    case: Case | str | Path,
    log: str | Path,
    *,
    subscribe: Subscribe | None = None,
    programs: Mapping[str, Firmware] | None = None,
) -> Result:
    """Run the case with the moves of lines in a log. The run has the same records as the session that wrote the log.

    subscribe: a function that is called with the recorder and the timebase, and can subscribe to records.
    programs: by the name of a unit, a Python function that runs in place of the unit's firmware in the case.

    Raise OutsideError if the log cannot be read or is damaged, or if a tick of the log has another length than a tick
    of the case; BadCase as in a `Session`.
    """
    case = case if isinstance(case, Case) else load(Path(case))
    try:
        reader = LogReader(Path(log))
        with Session(case, reader.head.wires, subscribe=subscribe, programs=programs) as session:
            if reader.head.ticks_per_second != session.ticks_per_second:
                found = f"case {reader.head.case} with {reader.head.ticks_per_second} ticks a second"
                other = f"case {case.name} has {session.ticks_per_second}"
                raise OutsideError(f"{log}: it is the log of {found}, and {other}; replay it with its own case")
            for tick, levels, sent in reader.instants():
                for wire, count in sent.items():
                    session.scene.uart.sent(wire, count)
                session.apply(tick, levels)
                session.advance(tick + 1)
            if reader.end > session.now:
                session.advance(reader.end)
            result = session.finish()
    except BadLog as error:
        raise OutsideError(str(error)) from None
    result.notes += [reader.unfinished] if reader.unfinished else []
    return result

"""`periph-sim serve CASE --pty`: run a case in real time. Other programs use an SCI of the case as a serial port.

With --i2cdriver, other programs use the I2C bus of the case like the bus of an I2CDriver. The command prints the path
of the port and, at the end, the verdicts and the lateness.
"""

from __future__ import annotations

import dataclasses
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import closing, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .command_frame import (
    address_given,
    command,
    given_options,
    pace_given,
    print_json,
    running_user_code,
    time_given,
)
from .shared_options import CHANGES, EIGHT_BITS, FRAME

if TYPE_CHECKING:
    from ...outside.live.i2cdriver_door import I2cDriverDoor
    from ...outside.live.port_door import PortDoor
    from ...outside.live.pty_door import PtyDoor
    from ...outside.live.rfc2217_door import Rfc2217Door
    from ...outside.serial_line import SerialLine
    from ...scene.case.model import Case
    from ...scene.result import Result


@command(
    "run",
    "periph-sim serve timing/imu_hil.toml --pty /tmp/dsp --for '10 s'",
    "periph-sim serve timing/imu_hil.toml --rfc2217 4000 --log live.jsonl",
    former={"--format": "--frame"},
)
@click.argument("case", type=click.Path(path_type=Path))
@click.option("--pty", "link", is_flag=False, flag_value="", metavar="[LINK]", help="A pseudo-terminal; LINK names it.")
@click.option("--port", "real", metavar="PORT", help="A real serial port instead: /dev/ttyUSB0.")
@click.option("--rfc2217", "tcp", metavar="[ADDRESS:]PORT", help="Over TCP, on this computer if no ADDRESS is given.")
@click.option(
    "--i2cdriver", "bus", is_flag=False, flag_value="", metavar="[LINK]", help="SDA and SCL, as an I2CDriver."
)
@click.option("--sci", default="scia", show_default=True, help="The SCI: scia, or UNIT.SCI-A.")
@click.option("--baud", default=115_200, show_default=True, help="Rate until a client sets another one.")
@FRAME
@click.option(
    "--pace", default="1", show_default=True, metavar="N", help="Simulated seconds a second; 0: at full speed."
)
@click.option(
    "--when-late",
    type=click.Choice(["slip", "catch-up", "stop"]),
    default="slip",
    show_default=True,
    help="Reaction to more than 50 ms of lateness.",
)
@click.option("--for", "length", metavar="TIME", help="End after this simulated time; else with Ctrl-C.")
@click.option("--warm-up", default="0 s", show_default=True, metavar="TIME", help="Simulated before the clock starts.")
@click.option("--log", type=click.Path(path_type=Path), help="Write the input from outside, for a replay.")
@click.option("--view", is_flag=True, help="Show its status, updated in place: rates, readings, flags, lateness.")
@click.option(
    "--browser",
    is_flag=False,
    flag_value="0",
    metavar="[[ADDRESS:]PORT]",
    help="The same as a page for a browser of this computer, with the wave of the last round.",
)
@CHANGES
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object at the end.")
def serve(
    case: Path,
    link: str | None,
    real: str | None,
    tcp: str | None,
    bus: str | None,
    sci: str,
    baud: int,
    frame: str | None,
    pace: str,
    when_late: Any,
    length: str | None,
    warm_up: str,
    log: Path | None,
    view: bool,
    browser: str | None,
    changes: tuple[str, ...],
    as_json: bool,
) -> int:
    """Run CASE in real time, with one of its SCIs as a serial port, or its bus as an I2CDriver.

    A program that opens the port replaces the [host] of the case, or its [controller]. Ctrl-C ends the run, and the
    verdicts are printed. Exit status 0: nothing hangs, and all budgets hold or the case has none; 1: otherwise.
    """
    from ...outside.live.case_for_line import case_for_bus, case_for_line
    from ...outside.live.loop import Loop, signals_calling
    from ...outside.live.pacing import Pacer
    from ...outside.session import Session
    from .live_display import LiveDisplay

    if sum(place is not None for place in (link, real, tcp, bus)) != 1:
        raise click.UsageError("give one of --pty, --rfc2217, --port and --i2cdriver as the place of the port")
    serial = [option for name, option in given_options().items() if name in ("sci", "baud", "frame")]
    if bus is not None and serial:
        raise click.UsageError(f"{' and '.join(serial)}: for serial ports only; --i2cdriver serves the I2C bus")
    if view and not sys.stdout.isatty():
        raise click.UsageError("--view needs a terminal; --browser shows the same on a page")
    stopped = threading.Event()
    with running_user_code() if as_json else nullcontext(), signals_calling(lambda *_: stopped.set()):
        served = case_for_line(case, sci, changes) if bus is None else case_for_bus(case, changes)
        shown = LiveDisplay(view, None if browser is None else address_given("--browser", browser))
        with Session(served, log=log, subscribe=shown.subscribe) as session:
            ticks = session.scene.timebase.ticks
            with shown:
                line: SerialLine | None = None
                door: PtyDoor | PortDoor | Rfc2217Door | I2cDriverDoor
                if bus is None:
                    line = session.serial(sci, baud, frame or EIGHT_BITS)
                    door = _door(line, (link, real, tcp), baud, frame or EIGHT_BITS, shown.say)
                else:
                    from ...outside.live.i2cdriver_door import I2cDriverDoor

                    door = I2cDriverDoor(session, Path(bus) if bus else None)
                with closing(door):
                    session.advance(session.now + ticks(time_given("--warm-up", warm_up), "nearest"))
                    pacer = Pacer(session.ticks_per_second, pace_given(pace), when_late)
                    end = None if length is None else session.now + ticks(time_given("--for", length), "nearest")
                    doors = [door, *shown.doors(session, line, pacer, door.path)]
                    for sentence in session.case.replaced:
                        click.echo(sentence, err=True)
                    click.echo(door.path, err=as_json)
                    if shown.url:
                        click.echo(shown.url, err=as_json)
                    shown.begin()
                    Loop(session, pacer, doors, stopped=stopped).run(end)
            for sentence in _not_handed_over(line, door):
                click.echo(sentence, err=True)
            result = session.finish()
    if pacer.late and result.wall_s * pace_given(pace) > result.simulated_s:
        click.echo(_slower(served, result), err=True)
    if as_json:
        late = {"worst_s": pacer.worst, "p99_s": pacer.percentile(0.99), "late": pacer.late, "slips": pacer.slips}
        print_json("serve", {**dataclasses.asdict(result), "lateness": late})
    else:
        from .result_text import show

        show(result, served)
        click.echo("\n".join(pacer.text()))
    return 0 if result.verdict != "fail" else 1


def _door(
    line: SerialLine, places: tuple[str | None, ...], baud: int, form: str, notify: Callable[[str], None]
) -> PtyDoor | PortDoor | Rfc2217Door:
    link, real, tcp = places
    if real is not None:
        from ...outside.live.port_door import PortDoor

        return PortDoor(line, real, baud, form, notify)
    if tcp is not None:
        from ...outside.live.rfc2217_door import Rfc2217Door

        address, port = address_given("--rfc2217", tcp)
        return Rfc2217Door(line, baud, form, port, address, notify)
    from ...outside.live.pty_door import PtyDoor

    return PtyDoor(line, baud, form, Path(link) if link else None, notify)


def _not_handed_over(line: SerialLine | None, door: PtyDoor | PortDoor | Rfc2217Door | I2cDriverDoor) -> Iterator[str]:
    """Yield remarks on bytes that were not sent or not read when the session ended, and on discarded bytes."""
    whose = "the I2CDriver" if line is None else "the SCI"
    waiting = door.unread + (0 if line is None else line.waiting)
    if waiting:
        yield f"{waiting} bytes for {whose} were not sent yet"
    if len(door.back):
        yield f"{len(door.back)} bytes of {whose} were not read"
    if door.back.lost:
        yield f"{door.back.lost} bytes of {whose} were discarded unread, since only a megabyte is kept"


def _slower(case: Case, result: Result) -> str:
    """Return a sentence that explains the lateness of a session by the speed of the simulation."""
    takes = result.wall_s / result.simulated_s
    images = " and ".join(name for name, unit in case.unit.items() if unit.image)
    why = f": {images} runs an image, instruction by instruction, its polls included" if images else ""
    return f"a simulated second takes {takes:.1f} s of this computer's time{why}; it keeps --pace {0.8 / takes:.2g}"

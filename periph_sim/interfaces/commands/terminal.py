"""`periph-sim terminal CASE`: run a case in real time with a terminal at its SCI."""

from __future__ import annotations

import codecs
import sys
from pathlib import Path
from urllib.parse import urlencode

import click

from .command_frame import command, pace_given
from .shared_options import CHANGES, EIGHT_BITS, FRAME

SHOWN = ("default", "direct", "nocontrol", "printable", "colorize", "debug")


@command(
    "run",
    "periph-sim terminal timing/uart_logger.toml --echo",
    "periph-sim terminal timing/uart_logger.toml --encoding hexlify",
    former={"--format": "--frame"},
)
@click.argument("case", type=click.Path(path_type=Path))
@click.option("--sci", default="scia", show_default=True, help="The SCI: scia, or UNIT.SCI-A.")
@click.option("--baud", default=115_200, show_default=True, type=click.IntRange(min=1), help="Rate of the terminal.")
@FRAME
@click.option("--pace", default="1", show_default=True, metavar="N", help="Simulated seconds a second.")
@click.option("--echo", is_flag=True, help="Also show typed characters.")
@click.option(
    "--eol", type=click.Choice(["cr", "lf", "crlf"]), default="crlf", show_default=True, help="Characters of Enter."
)
@click.option("--show", type=click.Choice(SHOWN), default="default", show_default=True, help="How bytes are shown.")
@click.option(
    "--encoding", default="UTF-8", show_default=True, help="Encoding of both directions; hexlify shows and reads hex."
)
@click.option("--log", type=click.Path(path_type=Path), help="Write the input from outside, for a replay.")
@CHANGES
def terminal(
    case: Path,
    sci: str,
    baud: int,
    frame: str | None,
    pace: str,
    echo: bool,
    eol: str,
    show: str,
    encoding: str,
    log: Path | None,
    changes: tuple[str, ...],
) -> int:
    """Type to an SCI of CASE, which runs in real time.

    The terminal is pyserial's miniterm (extra live). Ctrl-] ends it, and Ctrl-T Ctrl-H lists its keys, one of which
    sends a break. The user replaces the [host] of the case. At the end, the verdicts of the run are printed. Exit
    status 0: nothing hangs, and all budgets hold or the case has none; 1: otherwise.
    """
    try:
        from ...outside.live.protocol_f28335 import Serial
        from ...outside.live.terminal import Terminal
    except ImportError:
        raise click.ClickException("the terminal needs pyserial: pip install 'periph-sim[live]'") from None
    from serial import SerialException

    from ...outside.serial_line import port_settings

    frame = frame or EIGHT_BITS
    settings = [("port", sci), ("pace", pace), *(("set", change) for change in changes)]
    settings += [] if log is None else [("log", str(log))]
    url = f"f28335://{case}?{urlencode(settings)}"
    if pace_given(pace) == 0:
        raise click.UsageError("--pace 0: typing needs real time; give more than 0")
    if not sys.stdin.isatty():
        raise click.ClickException(f"standard input is no terminal; a script opens {url} with pyserial")
    try:
        codecs.lookup(encoding)
    except LookupError:
        raise click.UsageError(
            f"--encoding {encoding!r}: Python knows no such encoding; latin1 shows every byte"
        ) from None
    try:
        port = Serial(url, **port_settings(baud, frame), timeout=1)
    except (SerialException, ValueError) as error:
        raise click.ClickException(str(error)) from None
    typed = Terminal(port, echo, eol, show, encoding)
    typed.talk(f"{sci} of {case}, {baud} {frame}; Ctrl-] ends it, Ctrl-T Ctrl-H helps")
    port.close()
    click.echo()
    if typed.failed:
        raise click.ClickException(typed.failed)
    from .result_text import show as show_result

    assert port.result is not None
    show_result(port.result, port.case)
    click.echo("\n".join(port.pacer.text()))
    return 0 if port.result.verdict != "fail" else 1

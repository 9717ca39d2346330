"""`periph-sim diff A B`: compare two captures by their protocol events."""

from __future__ import annotations

from pathlib import Path

import click

from ...core.tolerance import Cycles, Tolerance
from ...traces.capture.channel_names import pairs_given
from ...traces.decode.uart_line import Line, line_of
from .command_frame import command, print_answer, read_capture
from .shared_options import JSON, MAP, SALVAGE, tolerance_option


@command(
    "traces",
    "periph-sim diff before.sr after.sr --tolerance 1us",
    "periph-sim diff before.sr after.sr --uart rx=RX,baud=115200",
)
@click.argument("a", type=click.Path(path_type=Path))
@click.argument("b", type=click.Path(path_type=Path))
@MAP
@click.option("--map-b", metavar="LINE=CHANNEL,...", help="The same for B, if different.")
@click.option("--uart", metavar="rx=CHANNEL,baud=RATE,...", help="Compare UART frames, not I2C; also format=8n1.")
@click.option("--rate", metavar="RATE", help="Sample rate of A, if the file has none: '4 MHz'.")
@click.option("--rate-b", metavar="RATE", help="The same for B.")
@SALVAGE
@tolerance_option()
@JSON
@click.option("--all", "everything", is_flag=True, help="List every event, and every difference.")
def diff(
    a: Path,
    b: Path,
    mapping: str | None,
    map_b: str | None,
    uart: str | None,
    rate: str | None,
    rate_b: str | None,
    salvage: bool,
    tolerance: Tolerance | None,
    as_json: bool,
    everything: bool,
) -> int:
    """Compare the events of captures A and B, one by one, and their times.

    Exit status 0: the events are the same, and their times, counted from the first event that is in
    both, differ by no more than the tolerance, by default one sample of A plus one sample of B; 1: otherwise.
    """
    from ...replay.channels import channel_map
    from ...traces.diff import diff_i2c, diff_uart, text_report

    if isinstance(tolerance, Cycles):
        raise click.ClickException("--tolerance in cycles: captures state no SYSCLKOUT; give a time, such as '133 ns'")
    channel, line = (None, None) if uart is None else _line(uart)
    wanted = "sda" if line is None else "rx"
    if channel is not None and mapping is not None:
        raise click.ClickException("--uart and --map both name the channel of rx; give one of them")
    captures = (
        read_capture(a, rate, salvage),
        read_capture(b, rate_b, salvage, "--rate-b"),
    )
    first = mapping if channel is None else f"rx={channel}"
    lines = [channel_map(captures[0], first), channel_map(captures[1], map_b or first)]
    for path, found in zip((a, b), lines, strict=True):
        if wanted not in found:
            way = "give --uart baud=RATE" if line is None else "map the channel with rx=CHANNEL"
            raise click.ClickException(f"{path}: the lines found are {' and '.join(found)}; {way}")
    if line is None:
        (scl, sda), (scl_b, sda_b) = ((found["scl"], found["sda"]) for found in lines)
        result = diff_i2c(*captures, (scl, sda), (scl_b, sda_b), tolerance)
    else:
        result = diff_uart(*captures, line, lines[0]["rx"], lines[1]["rx"], tolerance)
    if not result.entries:
        what = "I2C transfer" if line is None else "UART frame"
        raise click.ClickException(f"{a} and {b}: no {what} in either; the mapping may be wrong")
    print_answer("diff", text_report.as_json(result, everything) if as_json else text_report.text(result, everything))
    return 0 if result.equal else 1


def _line(text: str) -> tuple[str | None, Line]:
    """Parse the value of --uart, such as `rx=CHANNEL,baud=RATE,format=8n1`. Return the channel and the settings.

    The channel is None if it is not stated. Raise ClickException if the rate is missing, or a part is invalid.
    """
    given = pairs_given("--uart", text, ("rx", "baud", "format"))
    if given.get("baud", "auto") == "auto":
        raise click.ClickException(f"--uart {text}: the rate is not stated; expected baud=RATE, such as baud=115200")
    try:
        return given.get("rx"), line_of(given["baud"], given.get("format", "8n1"))
    except ValueError as error:
        sentence = str(error).removesuffix(", or auto")  # only `decode` accepts "auto"
        raise click.ClickException(f"--uart {text}: {sentence}") from None

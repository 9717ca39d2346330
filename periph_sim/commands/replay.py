"""`periph-sim replay CAPTURE`: play a capture against a firmware, print where the wires first disagree."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

import click
from rich.console import Console
from rich.table import Table

from .. import formats
from ..case.load import load
from ..case.settings import duration
from ..recording import recording
from ..replay.channels import channel_map
from ..replay.i2c import I2cReplay
from ..replay.report import Report
from ..replay.uart import UartReplay, line_format
from .progress import progress
from .run import recorded_modules
from .trouble import told_plainly


@click.command()
@click.argument("capture", type=click.Path(path_type=Path))
@click.option("--case", "case_file", required=True, type=click.Path(path_type=Path), help="The case with the firmware.")
@click.option("--map", "mapping", metavar="LINE=CHANNEL,...", help="scl=0,sda=1 or rx=0; a channel by name or index.")
@click.option("--rate", metavar="RATE", help="Samples a second, where the file does not say: '4 MHz'.")
@click.option("--address", "addresses", multiple=True, metavar="ADDRESS", help="I2C: an address of the firmware's.")
@click.option("--first", type=click.IntRange(min=1), metavar="N", help="I2C: only the first N transfers.")
@click.option("--longest-low", metavar="TIME", help="I2C: let SCL go after this long: '10 us'; else as captured.")
@click.option("--baud", type=click.IntRange(min=1), help="UART: the line's rate; else as the firmware sets it.")
@click.option("--format", "frame", metavar="FORMAT", help="UART: data bits, parity and stop bits with --baud: 8n1.")
@click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change one key of the case.")
@click.option("--record", type=click.Path(path_type=Path), help="Write the run to a file; its suffix says the format.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of a table.")
def replay(
    capture: Path,
    case_file: Path,
    mapping: str | None,
    rate: str | None,
    addresses: tuple[str, ...],
    first: int | None,
    longest_low: str | None,
    baud: int | None,
    frame: str | None,
    changes: tuple[str, ...],
    record: Path | None,
    as_json: bool,
) -> int:
    """Replay CAPTURE against the firmware of a case.

    Of an I2C capture the controller's half is played and the firmware's slave answers for itself; of a UART capture
    one line goes into SCI-A. Exit status 0: the wires agree with the capture; 1: they do not.
    """
    with told_plainly():
        case = load(case_file, list(changes))
        given = formats.read(capture, None if rate is None else _rate(rate))
        lines = channel_map(given, mapping)
        own = [_address(text) for text in addresses]
        low = None if longest_low is None else _low(longest_low)
        line = None if baud is None else line_format(baud, frame or "8n1")
        i2c_only = {"--address": own, "--first": first, "--longest-low": low}
        _refuse("rx" in lines, i2c_only, {"--baud": baud, "--format": frame})
        with recording(record, recorded_modules(case)) as (subscribe, ended_at):
            player: I2cReplay | UartReplay
            if "rx" in lines:
                player = UartReplay(case, given, lines["rx"], line, subscribe)
            else:
                player = I2cReplay(case, given, lines["scl"], lines["sda"], own, first, low, subscribe)
            with progress(case.name) as told:
                report = player.run(told)
            ended_at(player.kernel.now)
    if as_json:
        click.echo(json.dumps(dataclasses.asdict(report)))
    else:
        show(Console(), report)
    return 0 if report.verdict == "pass" else 1


def _refuse(uart: bool, i2c_only: Mapping[str, object], uart_only: Mapping[str, object]) -> None:
    """Options that would have no effect are mistakes."""
    for name, value in (i2c_only if uart else uart_only).items():
        if value:
            raise click.ClickException(f"{name} is for {'I2C' if uart else 'UART'} captures; this one is not mapped so")
    if uart_only["--format"] and not uart_only["--baud"]:
        raise click.ClickException("--format needs --baud; without both the line is read as the firmware sets the SCI")


def _rate(text: str) -> Fraction:
    try:
        return formats.rate_of(text)
    except ValueError as error:
        raise click.ClickException(f"--rate: {error}") from None


def _low(text: str) -> Fraction:
    try:
        low = duration(text)
    except ValueError as error:
        raise click.ClickException(f"--longest-low: {error}") from None
    if not low:
        raise click.ClickException("--longest-low: expected more than 0")
    return low


def _address(text: str) -> int:
    try:
        address = int(text, 0)
    except ValueError:
        address = -1
    if not 0 <= address <= 0x7F:
        raise click.ClickException(f"--address: {text!r} is no 7-bit address; expected 0 to 0x7F, right-aligned")
    return address


def show(console: Console, report: Report) -> None:
    """The report as a person reads it."""
    title = f"{report.case}, {report.capture}: {report.verdict.upper()}"
    table = Table(title=title, title_justify="left", title_style="bold", show_header=False)
    for name, value in rows(report):
        table.add_row(name, value)
    console.print(table)
    for line in report.notes:
        console.print(f"note: {line}", highlight=False, soft_wrap=True)
    if report.unknowns:
        console.print(f"open questions touched: {', '.join(report.unknowns)}", highlight=False, soft_wrap=True)


def rows(report: Report) -> list[tuple[str, str]]:
    """Name and value of each line of the table."""
    found = [("events as in the capture", f"{report.agreed} of {report.events}")]
    first = report.first_divergence
    if first is not None:
        found.append(("first divergence", f"expected {first.expected} {_at(first.capture_s)}"))
        found.append(("", f"found {first.found} {_at(first.replay_s)}"))
    found.append(("bytes", str(report.bytes)))
    if report.kind == "i2c":
        found.append(("answered by the firmware", ", ".join(report.addresses)))
        found.append(("NACKs", str(report.nacks)))
        found.append(("longest stretch", f"{report.stretch_worst_us:.3f} us"))
        found.append(("all stretches", f"{report.stretch_total_us:.3f} us"))
        found.append(("largest difference in time", f"{report.lag_worst_us:.3f} us"))
    else:
        found.append(("errors", ", ".join(f"{name} {count}" for name, count in report.errors.items())))
        found.append(("start bit to read, at most", f"{report.lag_worst_us:.3f} us"))
    found.append(("simulated", f"{report.simulated_s:.6f} s in {report.wall_s:.3f} s"))
    return found


def _at(seconds: float | None) -> str:
    return "" if seconds is None else f"at {seconds:.6f} s"

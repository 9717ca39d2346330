"""`periph-sim replay CAPTURE`: replay a capture against a firmware, and print the first differences on the wires."""

from __future__ import annotations

import dataclasses
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ...core.text_table import columns
from .command_frame import (
    command,
    command_line,
    i2c_address_given,
    print_json,
    print_table,
    progress,
    read_capture,
    require_distinct_outputs,
    running_user_code,
    say,
    time_given,
)
from .result_text import assumptions, budget_table, legend
from .shared_options import CHANGES, EIGHT_BITS, FRAME, JSON, MAP, RATE, SALVAGE, SVG, diagram_file, tolerance_option
from .watch import note_saved_results

if TYPE_CHECKING:
    from ...core.tolerance import Tolerance
    from ...replay.report import Divergence, HistoryEntry, Report
    from ...scene.case.model import Case
    from ...traces.capture.capture import Capture

DIVERGENCE = "divergence"  # name of the diagram's file, without suffix, if --svg names a folder
BEFORE, AFTER = 14, 4  # maximum numbers of changes of registers that are shown before and after a divergence


@command(
    "traces",
    "periph-sim replay capture.sr --case timing/responder.toml",
    "periph-sim replay capture.sr --case timing/responder.toml --tolerance '2 us'",
    former={"--format": "--frame", "--uart": "--uart-file"},
)
@click.argument("capture", type=click.Path(path_type=Path))
@click.option("--case", "case_file", required=True, type=click.Path(path_type=Path), help="The case with the firmware.")
@MAP
@click.option(
    "--uart-file",
    "serial",
    metavar="FILE[,rx=CHANNEL]",
    help="With an I2C capture: the capture of RX at the same time.",
)
@click.option("--offset", metavar="TIME", help="From the start of CAPTURE to that of --uart-file; '-2 ms' if before.")
@RATE
@SALVAGE
@click.option(
    "--loop",
    type=click.Choice(["closed", "open"]),
    help="I2C: decisions (closed) or edges (open) of the capture. [closed]",
)
@click.option("--as", "role", type=click.Choice(["slave", "master"]), help="I2C: role of the F28335. [slave]")
@tolerance_option()
@click.option("--address", "addresses", multiple=True, metavar="ADDRESS", help="I2C: an address of the firmware.")
@click.option("--first", type=click.IntRange(min=1), metavar="N", help="I2C: only the first N transfers.")
@click.option("--longest-low", metavar="TIME", help="I2C: release SCL after this time: '10 us'; else as captured.")
@click.option(
    "--patience",
    metavar="TIME",
    help="I2C: end if SCL is held low, polls are refused, or a script makes no progress, for longer. [200 ms]",
)
@click.option("--baud", type=click.IntRange(min=1), help="UART: the line's rate; else as the firmware sets it.")
@FRAME
@CHANGES
@click.option("--record", type=click.Path(path_type=Path), help="Write the run to a file; its suffix says the format.")
@SVG
@click.option("--html", type=click.Path(path_type=Path), help="Write a report with the waves of both sides.")
@click.option("--strict", is_flag=True, help="Exit status 1 also if something is ambiguous.")
@click.option("-v", "--verbose", is_flag=True, help="List the undocumented behaviours that the run assumed.")
@JSON
def replay(
    capture: Path,
    case_file: Path,
    mapping: str | None,
    serial: str | None,
    offset: str | None,
    rate: str | None,
    salvage: bool,
    loop: str | None,
    role: str | None,
    tolerance: Tolerance | None,
    addresses: tuple[str, ...],
    first: int | None,
    longest_low: str | None,
    patience: str | None,
    baud: int | None,
    frame: str | None,
    changes: tuple[str, ...],
    record: Path | None,
    svg: Path | None,
    html: Path | None,
    strict: bool,
    verbose: bool,
    as_json: bool,
) -> int:
    """Replay CAPTURE against the firmware of a case.

    \b
    --loop closed  the decisions of the controller in an I2C capture are played,
                   and the firmware's slave answers and stretches by itself
    --loop open    every edge of the capture goes to the chip; its outputs are
                   compared with the capture
    --as master    the captured targets' answers are played to the firmware's
                   own requests

    One line of a UART capture goes into SCI-A, edge by edge. An I2C and a UART capture of the same time, from one file
    or two, are a session, in which the case's budgets are measured.

    Exit status 0: the wires agree with the capture, and budgets and tolerance hold; 1: they do not, or nothing
    can be judged; 2: it cannot be replayed.
    """
    from ...records.recording import recording
    from ...replay.channels import ALL, channel_map
    from ...replay.i2c_closed_loop import I2cReplay
    from ...replay.i2c_master import I2cMasterReplay
    from ...replay.i2c_open_loop import I2cOpenReplay
    from ...replay.report import AMBIGUOUS, PASS
    from ...replay.session import SessionReplay
    from ...replay.setup import PATIENCE
    from ...replay.uart import UartReplay, line_format
    from ...scene.case.load import load
    from ...traces.formats import atomic_write

    svg = None if svg is None else diagram_file(svg, DIVERGENCE)
    require_distinct_outputs(record=record, svg=svg, html=html)
    with running_user_code():
        note_saved_results(case_file)
        case = load(case_file, list(changes))
        given = read_capture(capture, rate, salvage)
        both = serial is None and any({"I2C-A", "SCI-A"} <= set(unit.modules) for unit in case.unit.values())
        lines = channel_map(given, mapping, session=both)
        host = None if serial is None else _serial(serial, salvage)
        own = [i2c_address_given("--address", text) for text in addresses]
        low = None if longest_low is None else _above_zero("--longest-low", longest_low)
        wait = PATIENCE if patience is None else _above_zero("--patience", patience)
        line = None if baud is None else line_format(baud, frame or EIGHT_BITS)
        session = host is not None or len(lines) == len(ALL)
        is_uart, is_open, is_master = "rx" in lines, loop == "open", role == "master"
        uart_only = {"--baud": baud, "--frame": frame}
        i2c_only: dict[str, object] = {"--address": own, "--first": first, "--longest-low": low, "--patience": patience}
        i2c_only |= {"--loop": loop, "--as": role, "--tolerance": tolerance}
        slave_only = {"--loop open": is_open, "--address": own, "--longest-low": low}
        unused = {} if session else i2c_only if is_uart else uart_only
        kind = "I2C" if is_uart else "UART"
        refused = {
            **{f"{name} is for {kind} captures; this one is not mapped so": value for name, value in unused.items()},
            **{
                f"{name} is for a slave; as master the firmware makes the clock itself": is_master and value
                for name, value in slave_only.items()
            },
            "--longest-low is for --loop closed; in open loop every edge is the capture's": is_open and low is not None,
            "--patience is for --loop closed; an open loop does not wait for the firmware": is_open and patience,
            "--frame needs --baud; without both the line is read as the firmware sets the SCI": frame and not baud,
            "--uart-file needs an I2C capture; this one is a UART capture itself": host and "scl" not in lines,
            "--offset needs --uart-file; the channels of one file share one time": offset is not None and not host,
            "an I2C and a UART capture together are for --loop closed --as slave": session and (is_open or is_master),
        }
        for sentence, applies in refused.items():
            if applies:
                raise click.ClickException(sentence)
        later = "0 s" if offset is None else offset.strip()
        after = time_given("--offset", later.removeprefix("-").strip()) * (-1 if later.startswith("-") else 1)
        with recording(record, case.recorded_modules) as (subscribe, ended_at):
            player: UartReplay | I2cReplay | I2cOpenReplay | I2cMasterReplay
            if session:
                other, rx = (given, lines["rx"]) if host is None else host
                player = SessionReplay(
                    case,
                    given,
                    lines["scl"],
                    lines["sda"],
                    other,
                    rx,
                    after,
                    line,
                    own,
                    first,
                    low,
                    subscribe,
                    tolerance,
                    wait,
                )
            elif "rx" in lines:
                player = UartReplay(case, given, lines["rx"], line, subscribe)
            elif role == "master":
                player = I2cMasterReplay(case, given, lines["scl"], lines["sda"], first, subscribe, tolerance, wait)
            elif loop == "open":
                player = I2cOpenReplay(case, given, lines["scl"], lines["sda"], own, first, subscribe, tolerance)
            else:
                player = I2cReplay(
                    case, given, lines["scl"], lines["sda"], own, first, low, subscribe, tolerance, patience=wait
                )
            with progress(case.name) as on_progress:
                report = player.run(on_progress)
            ended_at(player.kernel.now, player.scene.clocks())
        picture = None if svg is None else player.picture(report)
        if svg is not None and picture is not None:
            with atomic_write(svg) as unfinished:
                unfinished.write_text(picture, encoding="utf-8")
        elif svg is not None:
            click.echo(f"{svg}: not written, since there is no divergence to draw", err=True)
        if html is not None:
            from ..reports.html.page import page
            from ..reports.html.replayed import replay_report

            with atomic_write(html) as unfinished:
                shown = replay_report(case, player, report, changes)
                unfinished.write_text(page([shown], shown.name, command_line()), encoding="utf-8")
    if as_json:
        print_json("replay", dataclasses.asdict(report))
    else:
        show(report, case, verbose)
    return 0 if report.verdict == PASS or (report.verdict == AMBIGUOUS and not strict) else 1


def _serial(text: str, salvage: bool) -> tuple[Capture, str]:
    """Parse the value of --uart-file: `host.sr`, `host.sr,rx=0`, `host.csv,rx=0,rate=4 MHz`.

    Return the capture in the file and the name of the channel of RX.
    """
    from ...replay.channels import serial_channel
    from ...traces.capture.channel_names import pairs_given

    path, comma, more = text.partition(",")
    given = pairs_given("--uart-file", more, ("rx", "rate")) if comma else {}
    capture = read_capture(Path(path), given.get("rate"), salvage, "--uart-file")
    return capture, serial_channel(capture, given.get("rx"))


def _above_zero(option: str, text: str) -> Fraction:
    length = time_given(option, text)
    if not length:
        raise click.ClickException(f"{option}: expected more than 0")
    return length


def show(report: Report, case: Case, verbose: bool) -> None:
    """Print the report of a replay. verbose: True to list the undocumented behaviours that the run assumed."""
    from ...replay.report import headline

    say(f"{report.case}, {report.capture}: {headline(report)}", style="bold")
    say("", *columns(rows(report), indent=" "), "")
    if report.budgets:
        budget_table(report.budgets)
        say(*legend(report.budgets))
    for divergence in report.divergences:
        show_history(divergence)
    say(*(f"note: {line}" for line in report.notes), *assumptions(report.unknowns, case, verbose))


def rows(report: Report) -> list[tuple[str, str]]:
    """Return the name and the value in each line of a report's table. A further line of a value has the name ""."""
    from ...replay.report import FIRST, at_text

    found = [("events as in the capture", f"{report.agreed} of {report.events}")]
    if report.ambiguous:
        found.append(("ambiguous", str(report.ambiguous)))
    if report.captured_errors:
        share = report.captured_errors / report.events
        found.append(("frames with errors in the capture", f"{report.captured_errors} of {report.events}, {share:.1%}"))
    for divergence in report.divergences:
        found.append((FIRST[divergence.kind], f"expected {divergence.expected} {at_text(divergence.capture_s)}"))
        found.append(("", f"found {divergence.found} {at_text(divergence.replay_s)}"))
        if divergence.cause:
            found.append(("", divergence.cause))
    found.append(("bytes", str(report.bytes)))
    if report.kind == "uart":
        found.append(("errors", ", ".join(f"{name} {count}" for name, count in report.errors.items())))
        found.append(("start bit to read, at most", f"{report.lag_worst_us:.3f} us"))
    else:
        who = "answered by the firmware" if report.role == "slave" else "answered as captured"
        plural = "es" * (len(report.addresses) != 1)
        found.append((who, f"address{plural} {', '.join(report.addresses) or 'none'}"))
        found.append(("NACKs", str(report.nacks)))
        if report.refusals != report.captured_refusals:
            found.append(("address refused", f"{report.refusals} times; {report.captured_refusals} in the capture"))
        for name, bounds in (("busy after a write", report.busy_us), ("in the capture", report.captured_busy_us)):
            if bounds:
                found.append((name, _busy(*bounds)))
        found += _times(report)
    found.append(("simulated", f"{report.simulated_s:.6f} s in {report.wall_s:.3f} s"))
    return found


def _busy(refused: float, acknowledged: float) -> str:
    if refused < acknowledged:
        return f"{refused / 1000:.3f} to {acknowledged / 1000:.3f} ms"
    return f"varies: NACK at {refused / 1000:.3f} ms, ACK at {acknowledged / 1000:.3f} ms"


def _times(report: Report) -> list[tuple[str, str]]:
    """Return the lines with the times of an I2C replay, and with the longest stretch in the capture if it has any."""
    stretch = f"{report.stretch_worst_us:.3f} us"
    if report.loop == "open":
        found = [
            ("longest stretch it would make", stretch),
            ("answer not ready by, at most", f"{report.late_worst_us:.3f} us"),
        ]
    else:
        found = [("largest difference in time", f"{report.lag_worst_us:.3f} us")]
        if report.lag_worst_us:
            found.append(("", f"{report.lag_samples:.1f} sample periods of the capture"))
        if report.role != "master":
            stretches = ("longest stretch", stretch), ("all stretches", f"{report.stretch_total_us:.3f} us")
            found = [*stretches, *found]
    if report.captured_stretch_us:
        found.append(("longest stretch or pause captured", f"{report.captured_stretch_us:.3f} us"))
    return found


def show_history(divergence: Divergence) -> None:
    """Print the last changes of registers before a divergence, and the first changes after the divergence."""
    from ...replay.report import FIRST

    if not divergence.history:
        return
    at = divergence.replay_s if divergence.replay_s is not None else divergence.history[-1].at_s
    before = _polls_as_one([change for change in divergence.history if change.at_s <= at])[-BEFORE:]
    after = _polls_as_one([change for change in divergence.history if change.at_s > at])[:AFTER]
    say(f"the chip around the {FIRST[divergence.kind]}", style="italic")
    rows = []
    for change in [*before, *after]:
        value = f"{change.value:04X}" if change.what[:2] in ("R ", "W ") else str(change.value)
        style = "dim" if change.at_s > at else ""
        rows.append(((f"{change.at_s:.9f} s", f"{(change.at_s - at) * 1e6:+.3f} us", change.what, value), style))
    print_table(("at", "", "register", "value"), rows, right=(0, 1, 3), whole=range(4))


def _polls_as_one(changes: list[HistoryEntry]) -> list[HistoryEntry]:
    """Return the changes, but only the first of consecutive changes with the same register and value, such as polls."""
    return [
        change
        for before, change in zip([None, *changes], changes, strict=False)
        if before is None or (before.what, before.value) != (change.what, change.value)
    ]

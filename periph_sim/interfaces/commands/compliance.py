"""`periph-sim compliance FILE`: judge a capture by every timing limit of the I2C-bus specification."""

from __future__ import annotations

from pathlib import Path

import click

from .command_frame import command, print_answer, read_capture
from .shared_options import JSON, MAP, RATE, SALVAGE


@command(
    "traces", "periph-sim compliance capture.sr --mode fast", "periph-sim compliance run.psr --mode standard --exact"
)
@click.argument("capture", type=click.Path(path_type=Path))
@click.option(
    "--mode",
    required=True,
    type=click.Choice(["standard", "fast", "fast-plus"]),
    help="Mode of the bus: up to 100 kHz, 400 kHz or 1 MHz.",
)
@MAP
@RATE
@SALVAGE
@click.option("--exact", is_flag=True, help="The file's times are exact, as in a simulation.")
@click.option("--strict", is_flag=True, help="Exit status 1 also if a limit cannot be decided.")
@JSON
def compliance(
    capture: Path,
    mode: str,
    mapping: str | None,
    rate: str | None,
    salvage: bool,
    exact: bool,
    strict: bool,
    as_json: bool,
) -> int:
    """Judge every I2C timing limit over the whole of CAPTURE.

    A limit passes, fails, or cannot be decided at the capture's sample rate. Exit status 0: no limit fails
    (with --strict: all are decided); 1: otherwise, or nothing was measured.
    """
    from ...replay.channels import channel_map
    from ...traces.compliance import Verdict, check
    from ...traces.compliance.report import as_json as as_dict
    from ...traces.decode.i2c_table import likely_cause

    given = read_capture(capture, rate, salvage)
    lines = channel_map(given, mapping)
    if "scl" not in lines:
        raise click.ClickException(f"{capture}: the limits are those of I2C; map it with --map scl=...,sda=...")
    if exact and given.sampled:
        raise click.ClickException(f"{capture}: its times are samples of an analyser, so --exact cannot be true")
    report = check(given, lines["scl"], lines["sda"], mode, exact=exact or None)
    if not report.starts:
        raise click.ClickException(
            f"{capture}: no I2C START on {lines['scl']!r} and {lines['sda']!r}; "
            + likely_cause(given, lines["scl"], lines["sda"])
        )
    print_answer("compliance", as_dict(report) if as_json else str(report))
    failed = report.verdict in (Verdict.FAIL, Verdict.NOT_JUDGED) or (strict and report.verdict is Verdict.UNDECIDABLE)
    return int(failed)

"""`periph-sim imu-table`: compares the sensor models at rest with Table 5.1 of the dissertation."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path

import click

from ...interfaces.commands.command_frame import command, print_json

MOST_SAMPLES = 10_000_000
PUBLISHED = "table_5_1"


@command(
    "sensors", "periph-sim imu-table --samples 10000", "periph-sim imu-table --parameters my.toml --write samples.csv"
)
@click.option(
    "--samples", type=click.IntRange(2, MOST_SAMPLES), default=10_000, show_default=True, help="Samples of every axis."
)
@click.option("--seed", type=int, default=1, show_default=True, help="Seed of the noise.")
@click.option(
    "--parameters",
    metavar="SET",
    help="A TOML file or a shipped set.  [default: table_5_1, which reproduces the table]",
)
@click.option("--turn", is_flag=True, help="Derive the earth field and show a turn about z (section 5.2) instead.")
@click.option("--write", "csv", type=click.Path(path_type=Path), metavar="FILE.csv", help="Also write the samples.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of a table.")
def imu_table(samples: int, seed: int, parameters: str | None, turn: bool, csv: Path | None, as_json: bool) -> int:
    """Run the sensor models at rest and print mean, 3 sigma and variance as Table 5.1 does.

    Each figure is shown beside the published figures and the expectation of the model. For the set that reproduces the
    table, its derivation from Table 4.1 is also shown, step by step.
    """
    from ..at_rest.rest import at_rest
    from ..at_rest.static_table import readings, static_table, text
    from ..models.parameters import ImuParameters
    from ..parameter_sets import named

    for option, given in (("--write", csv is not None), ("--json", as_json)):
        if turn and given:
            raise click.UsageError(f"{option} with --turn: a turn is shown as text only; remove one of them")
    with ExitStack() as outputs:
        unfinished = None
        if csv is not None:
            from ...traces.formats import atomic_write

            unfinished = outputs.enter_context(atomic_write(csv))
        if turn:
            from ..at_rest import earth_field

            click.echo(earth_field.text(named(parameters) if parameters else ImuParameters(), earth_field.fit()))
            return 0
        imu = named(parameters or PUBLISHED)
        found = at_rest(imu, samples, seed)
        if unfinished is not None:
            from ..at_rest.rest import write

            write(found, imu, unfinished)
        rows, found_readings = static_table(imu, found), readings() if parameters in (None, PUBLISHED) else []
    if as_json:
        explained = [{"says": reading.says, "emulator_mean_off_se": reading.off} for reading in found_readings]
        row_objects = list(map(asdict, rows))
        print_json("imu-table", {"samples": samples, "seed": seed, "rows": row_objects, "readings": explained})
    else:
        click.echo(text(imu, rows, found_readings, samples, seed))
    return 0

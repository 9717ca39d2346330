"""`periph-sim extremes`: limits and costs of the sensor models in float64, float32 and Q formats."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from ...interfaces.commands.command_frame import command, print_json

if TYPE_CHECKING:
    from ..numeric.estimate import Tables


@command("sensors", "periph-sim extremes --arithmetic q16", "periph-sim extremes --only 'roll rate' --plot errors.svg")
@click.option("--arithmetic", "names", multiple=True, metavar="NAME", help="float64, float32, q16, q12 saturating, ...")
@click.option("--only", multiple=True, metavar="EXTREME", help="Run only these extremes.")
@click.option("--seed", type=click.IntRange(min=0), default=0, help="Seed of the search in the working range.")
@click.option(
    "--samples", type=click.IntRange(100, 1_000_000), default=1000, help="Samples of that search; more find more."
)
@click.option(
    "--parameters", metavar="SET", help="Sensor parameters for range and costs: a TOML file or a shipped set."
)
@click.option(
    "--tables", type=click.Choice(["RAM", "boot ROM"]), default="RAM", help="Memory of the libraries' tables."
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of tables.")
@click.option("--plot", type=click.Path(path_type=Path), metavar="FILE", help="Draw error against cycles, .svg.")
def extremes(
    names: tuple[str, ...],
    only: tuple[str, ...],
    seed: int,
    samples: int,
    parameters: str | None,
    tables: Tables,
    as_json: bool,
    plot: Path | None,
) -> None:
    """Run the sensor models in several kinds of arithmetic at every extreme, and compare them with float64.

    Shows, for each arithmetic, the deviation in the working range and the cost in cycles. For each extreme, it shows
    the effect, such as wraps, NaN or off (a larger deviation than in the working range), with the first input that has
    it. NAME and EXTREME may be given several times.
    """
    from ...traces.formats import atomic_write
    from ..extremes import USUAL, report
    from ..extremes.plot import picture
    from ..extremes.text_report import as_json as as_dict
    from ..extremes.text_report import text
    from ..parameter_sets import named

    if plot is not None and plot.suffix != ".svg":
        raise click.ClickException(f"{plot}: the picture is SVG; give a name that ends with .svg")
    imu = None if parameters is None else named(parameters)
    found = report(names or USUAL, seed, samples, only, imu, tables)
    if plot is not None:
        with atomic_write(plot) as unfinished:
            unfinished.write_text(picture(found), encoding="utf-8")
    if as_json:
        print_json("extremes", as_dict(found))
    else:
        click.echo(text(found))
    if plot is not None and not as_json:
        click.echo(f"written: {plot}")

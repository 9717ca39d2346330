"""`periph-sim identify FILE.csv`: bias and noise of a sensor recorded at rest."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ...interfaces.commands.command_frame import command, print_json, rate_given

if TYPE_CHECKING:
    from ...traces.formats.unit_csv import Column
    from ..identification.identify import Identified

PICTURES = (".svg", ".png")
UNEVEN = 0.01  # maximum relative difference of the periods of two recordings


@command(
    "sensors",
    "periph-sim identify rest.csv --rate '50 Hz' --plot allan.svg",
    "periph-sim identify rest.csv --write-parameters my.toml",
    former={"--parameters": "--write-parameters"},
)
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE.csv")
@click.option("--rate", metavar="RATE", help="Sample rate, if there is no column 'time [s]': '50 Hz'.")
@click.option("--expect", multiple=True, metavar="NAME=VALUE", help="The true mean of a column.  [0]")
@click.option(
    "--undisturbed",
    type=click.Path(path_type=Path),
    metavar="FILE.csv",
    help="A recording without the disturbance: for hard iron.",
)
@click.option("--slow-terms", is_flag=True, help="Also identify bias instability and random walk.")
@click.option(
    "--plot", "picture", type=click.Path(path_type=Path), metavar="FILE", help="Draw the Allan plot, .svg or .png."
)
@click.option(
    "--write-parameters",
    "parameters",
    type=click.Path(path_type=Path),
    metavar="FILE.toml",
    help="A parameter set that the sensor models load.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of a table.")
def identify(
    file: Path,
    rate: str | None,
    expect: tuple[str, ...],
    undisturbed: Path | None,
    slow_terms: bool,
    picture: Path | None,
    parameters: Path | None,
    as_json: bool,
) -> int:
    """Find bias and noise density of every column of a recording at rest.

    The density is read from the overlapping Allan deviation at 1 s, on the slope of -1/2. The title of
    every column contains its unit: 'gyroscope_x [deg/s]'.
    """
    if picture is not None and picture.suffix.casefold() not in PICTURES:
        raise click.ClickException(f"--plot {picture}: its suffix is {picture.suffix!r}; expected .svg or .png")
    with ExitStack() as outputs:
        try:
            from ..identification import text_report as show
        except ModuleNotFoundError as error:
            raise click.ClickException(
                f"identify needs {error.name}, which is not installed: pip install 'periph-sim[sensors]'"
            ) from None
        from ...core.input_files import note_input
        from ...traces.formats import atomic_write

        for given in (file, undisturbed):
            if given is not None:
                note_input(given)
        paths = {path: outputs.enter_context(atomic_write(path)) for path in (picture, parameters) if path is not None}
        axes, period = _axes(file, rate, expect, undisturbed, slow_terms)
        count = len(axes[0].series.samples)
        title = f"{file}: {count} samples, one every {period:g} s"
        if picture is not None:
            from ..identification.plot import plot

            plot(title, axes, paths[picture])
        if parameters is not None:
            from ..at_rest.identified import parameters_of_axes
            from ..parameter_sets import text_of

            named = {axis.series.name: axis for axis in axes}
            found = parameters_of_axes(named, undisturbed is not None)
            paths[parameters].write_text(text_of(found), encoding="utf-8")
    if as_json:
        print_json("identify", {"file": str(file), "columns": show.as_json(axes)})
    else:
        click.echo(show.table(title, axes))
    return 0


def _axes(
    file: Path, rate: str | None, expect: tuple[str, ...], undisturbed: Path | None, slow: bool
) -> tuple[list[Identified], float]:
    """Identify every column of a file except time. Return the identified columns and the sampling period in seconds."""
    from ..identification.identify import identify as identified

    columns, period = _recording(file, rate)
    others: Mapping[str, Column] = {}
    if undisturbed is not None:
        others, other_period = _recording(undisturbed, rate)
        if abs(other_period / period - 1) > UNEVEN:
            raise click.ClickException(
                f"{undisturbed}: a sample every {other_period:g} s; expected every {period:g} s, as in {file}"
            )
    wanted = _expected(expect, columns)
    axes = []
    for name, column in columns.items():
        plain = None
        if undisturbed is not None:
            if name not in others or others[name].unit != column.unit:
                raise click.ClickException(
                    f"{undisturbed}: there is no column '{name} [{column.unit}]', unlike in {file}"
                )
            plain = others[name].values
        expected = wanted.get(name, 0.0)
        axes.append(
            identified(name, column.values, period, unit=column.unit, expected=expected, undisturbed=plain, slow=slow)
        )
    return axes, period


def _recording(file: Path, rate: str | None) -> tuple[dict[str, Column], float]:
    """Return the columns by their names, without the time column, and the sampling period in seconds."""
    import numpy as np

    from ...traces.formats.unit_csv import line_of_row, read

    columns = {column.name: column for column in read(file)}
    time = columns.pop("time", None)
    if not columns:
        raise click.ClickException(f"{file}: the only column is time; expected a sensor's, with its unit")
    if rate is not None:
        return columns, float(1 / rate_given("--rate", rate))
    if time is None or time.unit != "s":
        raise click.ClickException(f"{file}: there is no column 'time [s]'; state the rate with --rate: '50 Hz'")
    count = len(time.values)
    if count < 2:
        raise click.ClickException(f"{file}: there is only one row, so no rate; state it with --rate")
    steps = np.diff(time.values)
    usual = float(np.median(steps))
    uneven = np.flatnonzero(np.abs(steps - usual) > usual / 2)
    if len(uneven) or usual <= 0:
        row = int(uneven[0]) + 1 if len(uneven) else 1
        raise click.ClickException(
            f"{file}, line {line_of_row(file, row)}: {steps[row - 1]:.6g} s after the sample before, but usually "
            f"{usual:.6g} s; give a recording without gaps, or state the rate with --rate if only the times are wrong"
        )
    period = float(time.values[-1] - time.values[0]) / (count - 1)
    return columns, period


def _expected(given: tuple[str, ...], columns: Mapping[str, Column]) -> dict[str, float]:
    from ...core.phrases import did_you_mean

    wanted: dict[str, float] = {}
    for text in given:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals:
            raise click.ClickException(f"--expect {text!r}: expected NAME=VALUE")
        if name not in columns:
            raise click.ClickException(f"--expect {text!r}: there is no column {name!r}; {did_you_mean(name, columns)}")
        try:
            wanted[name] = float(value)
        except ValueError:
            raise click.ClickException(f"--expect {text!r}: {value!r} is not a number") from None
        if not isfinite(wanted[name]):
            raise click.ClickException(f"--expect {text!r}: expected a finite number")
    return wanted

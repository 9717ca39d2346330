"""`periph-sim trade CASE`: what each level of a case costs, and how far it is off."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import click

from .input_options import length_given
from .json_output import print_json
from .progress import progress
from .usage_error import running_user_code

SECTION = "understand"
EXAMPLE = "periph-sim trade timing/imu_hil.toml --level adaptive"

USUAL = Fraction(6, 100)  # seconds, where --seconds says nothing: a poll model makes each pass of each wait


@click.command()
@click.argument("case", type=click.Path(path_type=Path))
@click.option("--seconds", type=str, help="Simulate this long instead of the first 60 ms; 10 or '10 s'.")
@click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change one key of the case.")
@click.option("--level", "names", multiple=True, metavar="LEVEL", help="Leave out all other levels but edge.")
@click.option("--max-error", metavar="TIME", help="Name the cheapest level that is off by no more, as '1 us'.")
@click.option("--plot", type=click.Path(path_type=Path), metavar="FILE.svg", help="Draw worst error against CPU time.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of tables.")
def trade(
    case: Path,
    seconds: str | None,
    changes: tuple[str, ...],
    names: tuple[str, ...],
    max_error: str | None,
    plot: Path | None,
    as_json: bool,
) -> int:
    """Run CASE at every level, against edge: how far each is off, and what it costs.

    Levels are those of `fidelity`, of the firmware's arithmetic and of how waits are polled. What happens is paired by
    occurrence, the n-th set of a flag with the n-th; what a level lacks, adds or puts in another order is an infinite
    error. LEVEL may be given several times. Exit status 1 if no level is within TIME.
    """
    from ..reports.trade.choose import best_within
    from ..reports.trade.levels import chosen, levels_of
    from ..reports.trade.plot import picture
    from ..reports.trade.text_report import as_json as as_dict
    from ..reports.trade.text_report import text
    from ..reports.trade.trade import trade as trade_of
    from ..scene.case.load import load
    from ..traces.formats.atomic_write import atomic_write
    from .fidelity_choice import error_given

    with running_user_code():
        if plot is not None and plot.suffix != ".svg":
            raise click.ClickException(f"{plot}: the picture is SVG; give a name that ends with .svg")
        bound = None if max_error is None else error_given(max_error)
        loaded = load(case, list(changes))
        length = min(loaded.duration, USUAL) if seconds is None else length_given(seconds)
        levels = chosen(levels_of(loaded), names)
        with progress(loaded.name) as told:
            found = trade_of(lambda more: load(case, [*changes, *more]), levels, length, told)
        if plot is not None:
            with atomic_write(plot) as unfinished:
                unfinished.write_text(picture(found), encoding="utf-8")
    best = None if bound is None else best_within(found, bound)
    if as_json:
        print_json("trade", as_dict(found) | ({} if best is None else {"max_error": best.as_json()}))
    else:
        click.echo(text(found))
        if best is not None:
            click.echo(f"\n{best.text()}")
        if plot is not None:
            click.echo(f"written: {plot}")
    return 0 if best is None or best.level is not None else 1

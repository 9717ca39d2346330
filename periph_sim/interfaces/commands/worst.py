"""`periph-sim worst CASE [BUDGET]...`: explain the worst occurrence of each budget, and draw a timing diagram."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path
from shutil import get_terminal_size
from typing import TYPE_CHECKING

import click

from ...core.phrases import did_you_mean
from .command_frame import command, print_json, progress, running_user_code
from .completion import complete_budget
from .shared_options import CHANGES, SECONDS, SVG, diagram_file
from .watch import note_saved_results

if TYPE_CHECKING:
    from ...timing.verdict import Verdict
    from ..reports.explain.explain import Explained

MOST = 100  # maximum number of columns of a diagram in the terminal


@command(
    "understand",
    "periph-sim worst timing/imu_hil.toml response",
    "periph-sim worst timing/imu_hil.toml stretch --svg late.svg",
)
@click.argument("case", type=click.Path(path_type=Path))
@click.argument("budgets", nargs=-1, metavar="[BUDGET]...", shell_complete=complete_budget)
@SECONDS
@CHANGES
@SVG
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of text.")
def worst(
    case: Path,
    budgets: tuple[str, ...],
    length: Fraction | None,
    changes: tuple[str, ...],
    svg: Path | None,
    as_json: bool,
) -> int:
    """Explain the worst occurrence of each budget of CASE, step by step.

    BUDGET selects budgets by name; the default is all. One run of the case is judged. If a coverage or a proof that was
    saved (prove --save) matches the case, and its runs have a worse value of a budget, that occurrence is explained
    instead. With --set or --seconds, saved results are not used.

    Exit status 0: all selected budgets hold; 1: otherwise.
    """
    from ...scene.case.load import load
    from ...scene.scene import Scene
    from ..reports.explain import chain as chains
    from ..reports.explain.explain import explain
    from ..reports.saved_worst import saved_worst

    with running_user_code():
        note_saved_results(case)
        loaded = load(case, list(changes))
        names = [budget.name for budget in loaded.budget]
        for name in budgets:
            if name not in names:
                raise click.ClickException(f"{case}: there is no budget {name!r}; {did_you_mean(name, names)}")
        count = len(set(budgets or names))
        if svg is not None and not svg.is_dir() and count > 1:
            raise click.ClickException(f"--svg: {svg} is one file for {count} budgets; name one, or give a folder")
        scene = Scene(loaded)
        with progress(loaded.name) as on_progress:
            result = scene.run(length, on_progress)
        verdicts = [verdict for verdict in result.budgets if not budgets or verdict.name in budgets]
        saved = {} if changes or length is not None else saved_worst(case, verdicts)
        if not (saved or changes or length is not None):
            _say_if_out_of_date(case)
        verdicts = [saved[one.name].verdict if one.name in saved else one for one in verdicts]
        in_run = [verdict for verdict in verdicts if verdict.name not in saved]
        found = {one.window.verdict.name: one for one in explain(loaded, in_run, scene.typical(), length)}
        found |= {name: one.explained for name, one in saved.items() if one.explained is not None}
        if svg is not None:
            _write(svg, found)
    if as_json:
        shown = {name: chains.as_json(one.chain) for name, one in found.items()}
        for name, worst_saved in saved.items():
            if name in shown:
                shown[name] |= worst_saved.inputs
        print_json("worst", {"case": result.case, "budgets": shown})
    elif not verdicts:
        click.echo(f"{result.case}: it has no budget, so there is no worst case")
    else:
        texts = ([saved[one.name].text] if one.name in saved else [] for one in verdicts)
        lines = (_lines(verdict, found.get(verdict.name)) for verdict in verdicts)
        click.echo("\n\n".join("\n".join([*text, *each]) for text, each in zip(texts, lines, strict=True)))
    return 0 if all(verdict.passed for verdict in verdicts) else 1


def _say_if_out_of_date(case: Path) -> None:
    """Print on standard error why the coverage file of a case is not used, if there is one that does not match."""
    from ...proof.saved_paths import coverage_path
    from ..reports.coverage_line import phases_report

    report = phases_report(case) if coverage_path(case).exists() else None
    if report is not None and not report.worst:
        click.echo(f"{report.line}; this is the worst of one run", err=True)


def _lines(verdict: Verdict, one: Explained | None) -> list[str]:
    """Return the lines of an explanation and of its picture; one line if the verdict has no instant.

    one: the explanation of the worst occurrence; None if the verdict has no instant.
    """
    from ...timing.budget_schema import SILENCE
    from ..reports.explain import chain as chains
    from ..reports.explain.picture import text_picture

    if one is None:
        if verdict.worst is None:
            return [f"{verdict.name}: {verdict.found or 'nothing was measured'}"]
        is_silence = verdict.measure.startswith(SILENCE) and not verdict.worst
        never = "no answer came, as expected" if is_silence else f"{verdict.worst}: it never happened"
        return [f"{verdict.name}: {never}"]
    columns = min(MOST, max(80, get_terminal_size().columns))
    return [*chains.text(one.chain), "", *text_picture(one.window, columns)]


def _write(place: Path, found: dict[str, Explained]) -> None:
    """Write a file with a picture for each budget. If a file cannot be written, write none and raise BadCheck.

    Raise ClickException if two budgets would have the same file.

    place: the file, or the folder of the files.
    found: a dictionary from budgets to explanations.
    """
    from ..reports.baselines.files import write_all
    from ..reports.explain.picture import svg_picture

    names: dict[str, str] = {}
    for name in found:
        file = f"{re.sub(r'[^A-Za-z0-9]+', '_', name).strip('_') or 'budget'}.svg"
        if file in names:
            raise click.ClickException(f"--svg: budgets {names[file]!r} and {name!r} would both be {file}; rename one")
        names[file] = name
    if not found and not place.is_dir():
        click.echo(f"{place}: not written, since there is nothing to draw", err=True)
    write_all({diagram_file(place, Path(file).stem): svg_picture(found[name].window) for file, name in names.items()})

"""`periph-sim new KIND [NAME]`: a firmware and its case, ready to run; with `--example` a copy of a shipped case,
with `--live` a case of a live session.
"""

from __future__ import annotations

from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

import click

from ...core.suggest import did_you_mean
from .input_options import RATE, read_capture
from .usage_error import usage_errors_in_one_sentence

if TYPE_CHECKING:
    from .new_files import Files

SECTION = "run"
EXAMPLE = "periph-sim new i2c-slave thermometer"

REPLAY = "replay"


@click.command()
@click.argument("kind", required=False, shell_complete=lambda ctx, param, begun: _beginning(_kinds(), begun))
@click.argument("name", required=False)
@click.option(
    "--example",
    metavar="CASE",
    shell_complete=lambda ctx, param, begun: _beginning(_examples(), begun),
    help="Copy a shipped case with its firmware instead: imu_hil.",
)
@click.option(
    "--live", type=click.Path(path_type=Path), metavar="LOG", help="Make a case of a live session: serve --log."
)
@click.option("--from", "capture", type=click.Path(path_type=Path), metavar="CAPTURE", help="The capture to replay.")
@click.option(
    "--map", "mapping", metavar="LINE=CHANNEL,...", help="Channels of --from: scl=0,sda=1, if not clear by name."
)
@RATE
def new(
    kind: str | None,
    name: str | None,
    example: str | None,
    live: Path | None,
    capture: Path | None,
    mapping: str | None,
    rate: str | None,
) -> None:
    """Write a firmware and its case, ready to run, and show the next steps.

    \b
    i2c-slave     answers a controller from a few registers
    i2c-master    stores bytes in an EEPROM and reads them back
    sci-protocol  answers commands over SCI
    sensor        emulates a sensor whose model runs by a timer
    replay        answers like a captured target: --from capture.sr,
                  or a small capture that is written beside it

    NAME is that of the files, and may begin with a folder: bench/thermometer. With --example it is
    the folder of the copy. With --live the case is that of the session, driven by its log
    instead of its [host], with its budgets; if it has none, with the session's results as
    budgets. Existing files are never overwritten.
    """
    from . import new_files

    with usage_errors_in_one_sentence():
        if live is not None:
            if name is not None or capture is not None or example is not None:
                raise click.UsageError("--live takes at most the name of the case")
            from . import live_case

            files, case = live_case.files_of(live, kind)
            following = None
        elif example is not None:
            if name is not None or capture is not None:
                raise click.UsageError("--example takes at most the folder that the copy goes to")
            folder = Path(kind or ".")
            files = new_files.example(example, folder)
            case, following = folder / f"{example}.toml", None
        else:
            kind = _known(kind)
            if capture is not None and kind != REPLAY:
                raise click.UsageError(f"--from is for replay, not for {kind}")
            place = Path(name or kind.replace("-", "_"))
            files = new_files.template(kind, place)
            case, following = place.with_name(f"{place.name}.toml"), None
            if kind == REPLAY:
                recorded = place.with_name(f"{place.name}.vcd") if capture is None else capture
                if capture is not None:
                    given = read_capture(capture, rate)
                    files = new_files.as_captured(files, given, mapping)
                following = _replay(recorded, case, mapping, rate)
        new_files.write(files)
    for file in files:
        click.echo(f"written: {file}")
    for line in _go_on(files, case, following):
        click.echo(line)


def _kinds() -> list[str]:
    from .new_files import TEMPLATES

    return sorted(file.stem.replace("_", "-") for file in TEMPLATES.glob("*.toml"))


def _examples() -> list[str]:
    from ...core.examples import EXAMPLES

    return sorted(file.stem for file in (EXAMPLES / "timing").glob("*.toml"))


def _beginning(names: list[str], begun: str) -> list[str]:
    return [name for name in names if name.startswith(begun)]


def _known(kind: str | None) -> str:
    kinds = _kinds()
    if kind is None:
        raise click.UsageError(f"give a kind: {', '.join(kinds)}; or --example CASE")
    if kind not in kinds:
        raise click.UsageError(f"there is no kind {kind!r}; {did_you_mean(kind, kinds)}")
    return kind


def _replay(capture: Path, case: Path, mapping: str | None, rate: str | None) -> str:
    options = [("--map", mapping), ("--rate", rate), ("--tolerance", "2 us")]
    given = " ".join(f"{option} {quote(value)}" for option, value in options if value is not None)
    return f"periph-sim replay {quote(str(capture))} --case {quote(str(case))} {given}"


def _go_on(files: Files, case: Path, following: str | None) -> list[str]:
    shown = quote(str(case))
    lines = [f"run it:           periph-sim run {shown}"]
    lines += [f"replay:           {following}"] if following else []
    lines += [f"while you edit:   periph-sim watch {shown}"]
    lines += [f"keep its figures: periph-sim check {shown} --update-baseline"]
    if any('remove the "#"' in text for text in files.values() if isinstance(text, str)):
        lines.append('see it fail:      remove the "#" where the firmware says so')
    return lines

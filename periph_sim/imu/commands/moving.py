"""`periph-sim moving CASE`: compares attitudes from the emulator, from simulated chips and of the true motion."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import click

from ...interfaces.commands.command_frame import command, length_given, print_json, progress, running_user_code
from ...interfaces.commands.shared_options import CHANGES

DIFFERENT = 1  # the exit status if the bytes on the wires differ from the computed ones


@command(
    "sensors",
    "periph-sim moving timing/imu_moving.toml --direct",
    "periph-sim moving timing/imu_moving.toml --seconds 1 --plots .",
    former={"--plot": "--plots"},
)
@click.argument("case", type=click.Path(path_type=Path))
@click.option("--seconds", type=str, help="Run this long instead of the case's duration; 10 or '10 s'.")
@CHANGES
@click.option("--direct", is_flag=True, help="Without wires: compute the readings. Quick.")
@click.option(
    "--plots", "folder", type=click.Path(path_type=Path), metavar="FOLDER", help="Write attitudes.svg and rates.svg."
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of a table.")
def moving(
    case: Path, seconds: str | None, changes: tuple[str, ...], direct: bool, folder: Path | None, as_json: bool
) -> int:
    """Run the motion of CASE through the emulator and through simulated sensor chips, and compare the attitudes.

    The emulator is the case's firmware. It runs once with the gyroscope as built and once with the corrected one. The
    chips, called real sensors, take its place on the same bus. All readings go into the same filter.
    """
    from ...scene.case.load import load
    from ..moving.experiment import run
    from ..moving.subject import subject_of
    from ..moving.text_report import as_json as to_json
    from ..moving.text_report import lines

    with running_user_code(), ExitStack() as outputs:
        subject = subject_of(load(case, list(changes)), None if seconds is None else length_given(seconds))
        pictures = None if folder is None else outputs.enter_context(_pictures(folder))
        with progress(subject.case.name) as on_progress:
            outcome = run(subject, not direct, on_progress)
        if pictures is not None:
            from ..moving import plot

            plot.attitudes(outcome, pictures[0])
            plot.rates(outcome, pictures[1])
    if as_json:
        print_json("moving", to_json(outcome))
    else:
        click.echo("\n".join(lines(outcome)))
    return DIFFERENT if outcome.bytes is not None and outcome.bytes.different else 0


@contextmanager
def _pictures(folder: Path) -> Iterator[list[Path]]:
    """Create the folder if it is missing, and yield temporary paths for both pictures.

    If the `with` block succeeds, the pictures are moved to the folder. If it fails, the folder is removed again, if
    this function has created it.
    """
    from ...traces.formats import atomic_write

    try:
        import matplotlib  # noqa: F401
    except ImportError:
        raise click.ClickException("--plots needs matplotlib: pip install 'periph-sim[sensors]'") from None
    made = not folder.exists()
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise click.ClickException(f"--plots {folder}: {(error.strerror or 'an error').lower()}") from None
    try:
        with ExitStack() as both:
            yield [both.enter_context(atomic_write(folder / name)) for name in ("attitudes.svg", "rates.svg")]
    except BaseException:
        if made:
            folder.rmdir()
        raise

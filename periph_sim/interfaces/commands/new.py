"""`periph-sim new KIND [NAME]`: write a firmware and its case, ready to run; for an image or C sources, only a case.

With `--example`, the command copies a shipped case. With `--live`, it writes the case of a live session.
"""

from __future__ import annotations

import ast
import re
import tomllib
from collections.abc import Iterable
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

import click

from ...core.examples import EXAMPLES
from ...core.phrases import did_you_mean
from ...processor.image_files.assemble import sources_of
from ...scene.case.origin import texts_in
from ...scene.firmware_loader import SHIPPED
from .command_frame import check_file_name, command, read_capture, running_user_code
from .shared_options import MAP, RATE

if TYPE_CHECKING:
    from ...traces.capture.capture import Capture
    from .program_case import WrittenCase

REPLAY = "replay"
PROGRAMS = {
    "image": "a .out, as in periph-sim new image firmware.out",
    "c": "a folder, as in periph-sim new c firmware",
}
TEMPLATES = Path(__file__).with_name("templates")

REFUSES = '''"""A slave that answers like the captured target, by a shipped program; replace it by your own."""

from .responder import REPLAY, Settings, main

__all__ = ["REPLAY", "Settings", "main"]
'''

Files = dict[Path, str]


@command("run", "periph-sim new i2c-slave thermometer", "periph-sim new image firmware.out")
@click.argument("kind", required=False, shell_complete=lambda ctx, param, begun: _beginning(_kinds(), begun))
@click.argument("name", required=False)
@click.option(
    "--example",
    metavar="CASE",
    shell_complete=lambda ctx, param, begun: _beginning(_cases(), begun),
    help="Copy a shipped case with its firmware instead: imu_hil.",
)
@click.option(
    "--live", type=click.Path(path_type=Path), metavar="LOG", help="Make a case of a live session: serve --log."
)
@click.option("--from", "capture", type=click.Path(path_type=Path), metavar="CAPTURE", help="The capture to replay.")
@MAP
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
    i2c-slave     has a few registers that a controller writes and reads
    eeprom-slave  emulates an EEPROM: pages, busy time, wrap-around
    i2c-master    stores bytes in an EEPROM and reads them back
    sci-protocol  answers commands over SCI
    sensor        emulates a sensor whose model runs by a timer
    replay        answers like a captured target: --from capture.sr,
                  or a small capture that is written beside it
    image         runs a .out: periph-sim new image firmware.out
    c             runs the C sources below a folder: periph-sim new c firmware

    NAME is the name of the files, with or without a folder: bench/thermometer. For image and c it
    is the path of the program; the command runs the program to find modules, pins and limits for a case in
    the present folder. With --example NAME is the folder of the copy. With --live the new case is the case of
    the session, but the session's log replaces its [host] or [controller]. If that case has no budgets
    (also none by [[serial]] or [watch]), the session's results become budgets. Existing files are
    never overwritten.
    """
    following: str | None = None
    notes: list[str] = []
    if live is not None:
        if name is not None or capture is not None or example is not None:
            raise click.UsageError("--live takes at most the name of the case")
        from . import live_case

        files, case = live_case.files_of(live, kind)
    elif example is not None:
        if name is not None or capture is not None:
            raise click.UsageError("--example takes at most the folder that the copy goes to")
        folder = Path(kind or ".")
        files = _example(example, folder)
        case = folder / f"{example}.toml"
    elif kind is None:
        raise click.UsageError(f"give a kind: {', '.join(_kinds())}; or --example CASE")
    elif kind in PROGRAMS:
        made = _of_program(kind, name)
        files, case, notes = {made.path: made.text}, made.path, made.notes
        following = f"periph-sim worst {quote(str(case))} {quote(made.first)}" if made.first else None
    else:
        if kind not in _kinds():
            raise click.UsageError(f"there is no kind {kind!r}; {did_you_mean(kind, _kinds())}")
        if capture is not None and kind != REPLAY:
            raise click.UsageError(f"--from is for replay, not for {kind}")
        place = Path(name or kind.replace("-", "_"))
        files = _template(kind, place)
        case = place.with_name(f"{place.name}.toml")
        if kind == REPLAY:
            recorded = place.with_name(f"{place.name}.vcd") if capture is None else capture
            if capture is not None:
                files = _as_captured(files, read_capture(capture, rate), mapping)
            following = _replay(recorded, case, mapping, rate)
    write(files)
    said = [*(f"written: {file}" for file in files), *(f"note: {note}" for note in notes)]
    click.echo("\n".join([*said, *_go_on(files, case, following)]))


def _of_program(kind: str, name: str | None) -> WrittenCase:
    """Return the case of an image or of C sources. kind: a key of PROGRAMS. name: the path of the program."""
    if name is None:
        raise click.UsageError(f"new {kind} needs {PROGRAMS[kind]}")
    from . import program_case

    path = Path(name)
    with running_user_code():
        return program_case.image_case(path) if kind == "image" else program_case.sources_case(path)


def _kinds() -> list[str]:
    return sorted([*PROGRAMS, *(file.stem.replace("_", "-") for file in TEMPLATES.glob("*.toml"))])


def _cases() -> dict[str, Path]:
    """Return a dictionary from the names of the shipped cases to their paths."""
    return {file.stem: file for file in sorted((EXAMPLES / "timing").glob("*.toml"))}


def _beginning(names: Iterable[str], begun: str) -> list[str]:
    return [name for name in names if name.startswith(begun)]


def _replay(capture: Path, case: Path, mapping: str | None, rate: str | None) -> str:
    options = [("--map", mapping), ("--rate", rate), ("--tolerance", "2 us")]
    given = " ".join(f"{option} {quote(value)}" for option, value in options if value is not None)
    return f"periph-sim replay {quote(str(capture))} --case {quote(str(case))} {given}"


def _go_on(files: Files, case: Path, following: str | None) -> list[str]:
    shown = quote(str(case))
    lines = [f"run it:           periph-sim run {shown}"]
    if following:
        lines.append(f"{'replay: ' if following.startswith('periph-sim replay') else 'explain:'}          {following}")
    lines += [f"while you edit:   periph-sim watch {shown}"]
    lines += [f"keep its figures: periph-sim check {shown} --update-baseline"]
    if any('remove the first "#"' in text for text in files.values() if isinstance(text, str)):
        lines.append('see it fail:      remove the first "#" where the firmware says so')
    return lines


def _template(kind: str, place: Path) -> Files:
    """Return the files of a template with the name that the user gave.

    kind: the name of the template.
    place: the folder and the name of the new files, without a suffix.
    """
    check_file_name(place)
    stem = kind.replace("-", "_")
    found = {}
    for file in sorted(TEMPLATES.glob(f"{stem}.*")):
        text = file.read_text(encoding="utf-8")
        if file.suffix == ".toml":
            text = text.replace(f'"{stem}"', f'"{place.name}"').replace(f'"{stem}.py"', f'"{place.name}.py"')
        found[place.with_name(f"{place.name}{file.suffix}")] = text
    return found


def _as_captured(files: Files, capture: Capture, mapping: str | None) -> Files:
    """Return the files of the template `replay`, adapted to the most frequent target in the user's capture.

    files: the files of the template. The capture of the template is left out.
    """
    from ...replay.channels import channel_map
    from ...replay.i2c_script import most_frequent, turns
    from ...traces.decode import i2c
    from ...traces.decode.i2c_table import likely_cause

    lines = channel_map(capture, mapping)
    if "rx" in lines:
        raise click.ClickException(
            f"{capture.path}: is a UART capture; periph-sim new --example uart_logger makes a case to replay it against"
        )
    found = list(turns(i2c.transfers(capture, lines["scl"], lines["sda"])))
    address = most_frequent(found)
    if address is None:
        raise click.ClickException(
            f"{capture.path}: no I2C transfer with an address in it; "
            + likely_cause(capture, lines["scl"], lines["sda"])
        )
    lengths = [len(turn.answer.data) for turn in found if turn.address == address and turn.read and turn.answer.ack]
    refused = any(turn.address == address and not (turn.answer.ack and all(turn.answer.acks)) for turn in found)
    made = {}
    for path, text in files.items():
        if path.suffix == ".py" and refused:
            text = REFUSES
        if path.suffix == ".toml":
            text = text.replace("address = 0x48", f"address = {address:#04x}")
            text = text.replace("count = 2", f"count = {max(lengths, default=1)}")
        if path.suffix != ".vcd":
            made[path] = text
    return made


def _example(name: str, folder: Path) -> Files:
    """Return the files of a shipped case: the case, its firmware with all imports, and the files that the case names.

    Images and C sources that the case names are always included. Other files that it names are included only if they
    are in the folder of the case.
    """
    cases = _cases()
    if name not in cases:
        raise click.ClickException(f"there is no example {name!r}; {did_you_mean(name, cases)}")
    text = cases[name].read_text(encoding="utf-8")
    tree = tomllib.loads(text)
    found: Files = {}
    for unit in tree.get("unit", {}).values():
        if "firmware" not in unit:
            for said in [unit["image"]] if "image" in unit else unit["sources"]:
                source = (cases[name].parent / said).resolve()
                text = text.replace(f'"{said}"', f'"{source.name}"')
                sources = sources_of(source) if "image" in unit else _with_headers(source)
                found |= {folder / file.name: file.read_text(encoding="utf-8") for file in sources}
            continue
        program = unit["firmware"]
        text = text.replace(f'firmware = "{program}"\n', f'firmware = "{program}.py"\n')
        for module in _imported(program):
            found[folder / f"{module}.py"] = (SHIPPED / f"{module}.py").read_text(encoding="utf-8")
    for said in texts_in(tree):
        file = cases[name].parent / said
        if len(said) < 200 and Path(said).name == said and file.is_file():
            found[folder / said] = file.read_text(encoding="utf-8")
    return {folder / f"{name}.toml": text, **found}


def _with_headers(source: Path) -> list[Path]:
    """Return a C file and the headers in its folder that it includes, directly or not."""
    found = [source]
    for file in found:
        names = re.findall(r'^#include "([^"/]+)"', file.read_text(encoding="utf-8"), re.M)
        found += [header for name in names if (header := source.with_name(name)) not in found and header.is_file()]
    return found


def _imported(program: str) -> list[str]:
    """Return the name of a shipped program and of all modules in its folder that it imports, directly or not."""
    found = [program]
    for name in found:
        for node in ast.walk(ast.parse((SHIPPED / f"{name}.py").read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level == 1:
                names = [node.module] if node.module else [alias.name for alias in node.names]
                found += [module for module in names if module not in found]
    return found


def write(files: Files) -> None:
    """Write all files. If one of them exists already, write none and raise ClickException."""
    from ..reports.baselines.files import write_all

    there = [str(path) for path in files if path.exists() or path.is_symlink()]
    if there:
        raise click.ClickException(f"{', '.join(there)}: exists already, and nothing was written; give another name")
    write_all(files)

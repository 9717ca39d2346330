"""Files of `new`: from a template or a shipped case."""

from __future__ import annotations

import ast
import re
import tomllib
from pathlib import Path

import click

from ...core.examples import EXAMPLES
from ...core.suggest import did_you_mean
from ...processor.image_files.assemble import sources_of
from ...scene.case.origin import texts_in
from ...scene.firmware_loader import SHIPPED
from ...traces.capture.capture import Capture

TEMPLATES = Path(__file__).with_name("templates")
NAME = re.compile(r"[A-Za-z0-9_][\w.-]*")

REFUSES = '''"""A slave that answers like the captured target, by a shipped program; replace it by your own."""

from .responder import REPLAY, Settings, main

__all__ = ["REPLAY", "Settings", "main"]
'''

Files = dict[Path, str]


def template(kind: str, place: Path) -> Files:
    """Return the files of a template under another name. place: folder and name, without a suffix."""
    if not NAME.fullmatch(place.name):
        raise click.ClickException(f"{place.name!r} is no name for files; expected letters, digits, '_' and '-'")
    stem = kind.replace("-", "_")
    found = {}
    for file in sorted(TEMPLATES.glob(f"{stem}.*")):
        text = file.read_text(encoding="utf-8")
        if file.suffix == ".toml":
            text = text.replace(f'"{stem}"', f'"{place.name}"').replace(f'"{stem}.py"', f'"{place.name}.py"')
        found[place.with_name(f"{place.name}{file.suffix}")] = text
    return found


def as_captured(files: Files, capture: Capture, mapping: str | None) -> Files:
    """Return the files of a replay, for the target in a capture, without the template's own capture."""
    from ...replay.channels import channel_map
    from ...replay.i2c_script import most_frequent, turns
    from ...traces.decode import i2c

    lines = channel_map(capture, mapping)
    if "rx" in lines:
        raise click.ClickException(
            f"{capture.path}: is a UART capture; periph-sim new --example uart_logger makes a case to replay it against"
        )
    found = list(turns(i2c.transfers(capture, lines["scl"], lines["sda"])))
    address = most_frequent(found)
    if address is None:
        raise click.ClickException(
            f"{capture.path}: no I2C transfer with an address in it; the lines of --map may be swapped"
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


def example(name: str, folder: Path) -> Files:
    """Return a shipped case, its firmware with all imports, and the files beside it that it names."""
    cases = {file.stem: file for file in sorted((EXAMPLES / "timing").glob("*.toml"))}
    if name not in cases:
        raise click.ClickException(f"there is no example {name!r}; {did_you_mean(name, cases)}")
    text = cases[name].read_text(encoding="utf-8")
    tree = tomllib.loads(text)
    found: Files = {}
    for unit in tree.get("unit", {}).values():
        if "image" in unit:
            source = (cases[name].parent / unit["image"]).resolve()
            text = text.replace(f'image = "{unit["image"]}"', f'image = "{source.name}"')
            found |= {folder / file.name: file.read_text(encoding="utf-8") for file in sources_of(source)}
            continue
        if "sources" in unit:
            for said in unit["sources"]:
                source = (cases[name].parent / said).resolve()
                text = text.replace(f'"{said}"', f'"{source.name}"')
                found |= {folder / file.name: file.read_text(encoding="utf-8") for file in _with_headers(source)}
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
    """Return a C file, and the headers beside it that it includes."""
    found = [source]
    for file in found:
        names = re.findall(r'^#include "([^"/]+)"', file.read_text(encoding="utf-8"), re.M)
        found += [header for name in names if (header := source.with_name(name)) not in found and header.is_file()]
    return found


def _imported(program: str) -> list[str]:
    """Return a shipped program, and those that it imports from its own folder."""
    found = [program]
    for name in found:
        for node in ast.walk(ast.parse((SHIPPED / f"{name}.py").read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level == 1:
                names = [node.module] if node.module else [alias.name for alias in node.names]
                found += [module for module in names if module not in found]
    return found


def write(files: Files) -> None:
    """Write all files, or none if one exists."""
    there = [str(path) for path in files if path.exists() or path.is_symlink()]
    if there:
        raise click.ClickException(f"{', '.join(there)}: exists already, and nothing was written; give another name")
    written: list[Path] = []
    try:
        for path, text in files.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            with path.open("x", encoding="utf-8", newline="\n") as file:
                written.append(path)
                file.write(text)
    except OSError as error:
        for path in written:
            path.unlink()
        raise click.ClickException(f"{error.filename or written[-1]}: cannot be written ({error.strerror})") from None

"""An option name has one meaning in all commands: it takes the same kind of value. Former names print a notice."""

from __future__ import annotations

import re
from collections import defaultdict
from pathlib import Path

import click
import pytest

from periph_sim.cli import cli
from periph_sim.interfaces.commands.command_frame import Command
from periph_sim.outside.serial_line import parts_of_format
from periph_sim.replay import BadReplay
from periph_sim.replay.uart import line_format
from tests.interfaces.commands.conftest import Run

COMMANDS: dict[str, click.Command] = {
    name: found
    for name in cli.list_commands(None)  # type: ignore[arg-type]
    if (found := cli.get_command(None, name)) is not None  # type: ignore[arg-type]
}
FORMER = [
    (name, old, new) for name, one in COMMANDS.items() if isinstance(one, Command) for old, new in one.former.items()
]


def kind_of(option: click.Option) -> tuple[object, ...]:
    """Return a description of the values that an option accepts."""
    choices = tuple(option.type.choices) if isinstance(option.type, click.Choice) else ()
    return option.type.name.removesuffix(" range"), option.metavar, option.is_flag, choices


def test_an_option_takes_the_same_kind_of_value_in_all_commands():
    kinds: dict[str, dict[tuple[object, ...], list[str]]] = defaultdict(lambda: defaultdict(list))
    for name, one in COMMANDS.items():
        for option in one.params:
            if isinstance(option, click.Option) and not option.hidden:
                for spelling in option.opts:
                    kinds[spelling][kind_of(option)].append(name)
    assert len(kinds["--tolerance"]) == 1 and sum(map(len, kinds["--tolerance"].values())) == 3
    assert {spelling: dict(found) for spelling, found in kinds.items() if len(found) > 1} == {}


@pytest.mark.parametrize("option", ["--map", "--svg", "--tolerance", "--frame", "--set", "--log"])
def test_an_option_has_the_same_help_in_all_commands(option: str):
    options = [one for command in COMMANDS.values() for one in command.params if isinstance(one, click.Option)]
    helps = {one.help for one in options if option in one.opts}
    assert len(helps) == 1


def test_the_help_of_frame_names_the_parities_that_each_command_accepts():
    (frame,) = (one for one in COMMANDS["replay"].params if "--frame" in one.opts)
    assert isinstance(frame, click.Option) and frame.help is not None
    everywhere, in_replay = re.findall(r"((?:\w, )+\w or \w)", frame.help)
    for parity in "noems":
        assert parts_of_format(f"8{parity}1") == (8, parity, 1) and parity in re.findall(r"\b\w\b", everywhere)
        if parity in re.findall(r"\b\w\b", in_replay):
            assert line_format(115200, f"8{parity}1").bits == 8
        else:
            with pytest.raises(BadReplay):
                line_format(115200, f"8{parity}1")


@pytest.mark.parametrize(("name", "old", "new"), FORMER)
def test_a_former_name_sets_the_present_option_and_prints_a_notice(
    capsys: pytest.CaptureFixture[str], name: str, old: str, new: str
):
    command = COMMANDS[name]
    (option,) = (one for one in command.params if new in one.opts)
    for words in ([f"{old}=x"], [old, "x"]):
        context = command.make_context(name, [*words, "y"], resilient_parsing=True)
        assert context.params[option.name or ""] in ("x", ("x",), Path("x"))
        assert capsys.readouterr().err == ""
    with pytest.raises(click.UsageError):
        command.make_context(name, [f"{old}=x", "--nothing"])
    assert capsys.readouterr().err == f"{old} of {name} is now {new}; the next release refuses {old}\n"
    assert old not in {spelling for one in command.params for spelling in one.opts}


def test_a_former_name_still_works(periph_sim: Run, desk: Path):
    result = periph_sim("serve", "small.toml", "--i2cdriver", "--format", "8e1")
    assert result.err.startswith("--format of serve is now --frame; the next release refuses --format\n")
    assert "--frame: for serial ports only" in result.err

"""Find the lines of a capture by an option, such as `scl=0,sda=1`, or by the names of its channels.

Without an option, the names of the channels are searched. An I2C bus is a pair of SCL and SDA; RX and TX are serial
lines:

SCL, SDA                                             one bus
EEPROM SCL, EEPROM SDA, SCL2, SDA2                   two buses: both names of a pair contain the same word or number
Channel 0 (SDA), Channel 1 (SCL)                     one bus, because no other channel can be SCL or SDA
SCL_A, SDA_A, SCL_B                                  one bus; SCL_B has no partner
tb.scl, tb.dut.scl, tb.sda, tb.dut.sda               one bus if both scopes show the same edges
UART RX, TX2                                         two serial lines
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

import numpy as np

from ...core.input_error import InputError
from ...core.phrases import did_you_mean
from .capture import Capture, Channel


def channels_named(capture: Capture, line: str) -> list[Channel]:
    """Return the channels named `line`, such as "scl"; if there are none, the channels with this word in their names.

    Case and scopes (`tb.bus.scl`) are ignored. `Channel 0 (SDA)`, `24LC515 SCL` and `i2c_scl` have the word; `SCL2` and
    `MISCL` do not.
    """
    names = {channel.index: channel.name.rpartition(".")[2].casefold() for channel in capture.channels}
    found = [channel for channel in capture.channels if names[channel.index].strip() == line]
    return found or [c for c in capture.channels if line in re.split(r"[^0-9a-z]+", names[c.index])]


LINE = re.compile(r"(scl|sda|rx|tx)(\d*)")
PLACE = re.compile(r"channel|(ch|d|a)?\d+")  # a word that names an input of the analyser, and not a bus

Key = tuple[str, ...]


class Named(NamedTuple):
    """The buses of a capture.

    i2c: SCL and SDA of each I2C bus.
    uart: the lines with the word RX or TX, possibly with a number, in their names.
    left_over: the SCL and SDA lines without a partner.
    Of several lines of the same kind with equal edges, only the first one is listed.
    """

    i2c: list[tuple[Channel, Channel]]
    uart: list[Channel]
    left_over: list[Channel]


class _Line(NamedTuple):
    line: str
    # For `tb.eeprom_scl2`, `line` is "scl", and `key` has the scope `tb`, the other word `eeprom` and the number 2.
    key: Key
    channel: Channel


def buses_named(capture: Capture) -> Named:
    """Return the buses of a capture, in the order of their channels."""
    lines = [line for channel in capture.channels if (line := _line(channel))]
    lines = [line for n, line in enumerate(lines) if not any(_same(line, before) for before in lines[:n])]
    left = [line for line in lines if line.line in ("scl", "sda")]
    found: list[tuple[Channel, Channel]] = []
    for alike in (lambda line: line.key, _key_without_places, lambda _: ()):
        for scl, sda in _pairs(left, alike):
            found.append((scl.channel, sda.channel))
            left = [line for line in left if line is not scl and line is not sda]
    found.sort(key=lambda pair: min(pair[0].index, pair[1].index))
    uart = [line.channel for line in lines if line.line in ("rx", "tx")]
    return Named(found, uart, [line.channel for line in left])


def _line(channel: Channel) -> _Line | None:
    scope, _, name = channel.name.casefold().rpartition(".")
    words = re.split(r"[^0-9a-z]+", name)
    for place, word in enumerate(words):
        if match := LINE.fullmatch(word):
            others = (other for other in (*words[:place], *words[place + 1 :]) if other)
            return _Line(match[1], (scope, *others, f"#{match[2]}"), channel)
    return None


def _same(line: _Line, other: _Line) -> bool:
    """Return True if two lines of the same kind have equal edges, and so seem to be one wire in two scopes."""
    a, b = line.channel, other.channel
    return line.line == other.line and len(a.edges) > 0 and a.initial == b.initial and np.array_equal(a.edges, b.edges)


def _key_without_places(line: _Line) -> Key:
    return tuple(word for word in line.key if not PLACE.fullmatch(word))


def _pairs(lines: Iterable[_Line], alike: Callable[[_Line], Key]) -> list[tuple[_Line, _Line]]:
    """Return a pair of SCL and SDA for each key that exactly one SCL and exactly one SDA have.

    alike: a function that returns the key of a line.
    """
    groups: dict[Key, dict[str, list[_Line]]] = {}
    for line in lines:
        groups.setdefault(alike(line), {"scl": [], "sda": []})[line.line].append(line)
    return [(scl[0], sda[0]) for scl, sda in (group.values() for group in groups.values()) if len(scl) == len(sda) == 1]


def pairs_given(option: str, text: str, known: tuple[str, ...], flags: tuple[str, ...] = ()) -> dict[str, str]:
    """Parse the value of an option, such as `rx=2,baud=9600,vote`, to a dictionary.

    option: the name of the option, for messages.
    known: the names that need a value.
    flags: the names that may have no value.

    Raise InputError for other names, for a name that occurs twice, and for a missing value.
    """
    given: dict[str, str] = {}
    for part in text.split(","):
        name, equals, value = part.partition("=")
        name = name.strip().casefold()
        if name not in known + flags:
            raise InputError(f"{option} {text}: there is no {name!r}; {did_you_mean(name, known + flags)}")
        if name in given:
            raise InputError(f"{option} {text}: {name} is given twice; expected once")
        if name not in flags and not value.strip():
            raise InputError(f"{option} {text}: {name} has no value; expected {name}=...")
        given[name] = value.strip() or equals
    return given


def channels_given(
    capture: Capture, option: str, text: str, given: Mapping[str, str], lines: Mapping[str, str]
) -> dict[str, Channel]:
    """Return a dictionary from lines, such as "mosi", to the channels that an option assigns to these lines.

    option, text: the name and the value of the option, for messages.
    given: the settings in the value of the option, as `pairs_given` returns them.
    lines: a dictionary from names of settings to lines. A line may have several names: mosi and simo are one line.

    Raise InputError if two settings are for the same line, if a channel is missing or ambiguous, or if two lines have
    the same channel.
    """
    found: dict[str, Channel] = {}
    for name, line in lines.items():
        if name in given and line in found:
            raise InputError(f"{option} {text}: {name} and {line} are one line; give one of them")
        if name in given:
            try:
                found[line] = capture.channel(given[name])
            except LookupError as error:
                raise InputError(f"{option} {text}: {error.args[0]}") from None
    if len({channel.index for channel in found.values()}) < len(found):
        raise InputError(f"{option} {text}: two lines are one channel; expected a channel each")
    return found

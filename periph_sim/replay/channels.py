"""Assignment of a capture's channels to the lines SCL, SDA and RX, by a text (`scl=0,sda=1`) or by the channels' names.

An I2C capture has scl and sda, a UART capture has only rx, and a capture of a session has all three.
"""

from __future__ import annotations

from ..traces.capture.capture import Capture, listed
from ..traces.capture.channel_names import channels_given, channels_named, pairs_given
from ..traces.decode.i2c_table import swapped_lines
from . import BadReplay

I2C, UART = ("scl", "sda"), ("rx",)
ALL = (*I2C, *UART)
# The argument `lines` of `channels_given`, which maps names of settings to lines. Here, the only name of each line is
# its own.
LINES = {line: line for line in ALL}


def channel_map(capture: Capture, text: str | None, session: bool = False) -> dict[str, str]:
    """Return the channel for each line: scl and sda, or rx, or all three.

    The result maps each line to the name of its channel, or to its index if `text` has an index.

    text: the assignment that the user gives, such as "scl=0,sda=1". None: find the channels by their names; SCL and SDA
        are preferred to RX.
    session: used if `text` is None. True: return all three lines if the capture has them.

    Raise InputError if there are no such channels, if `text` is wrong, or if SCL and SDA are swapped.
    """
    found = _mapped(capture, text, session)
    if "scl" in found and (swapped := swapped_lines(capture, found["scl"], found["sda"])):
        found["scl"], found["sda"] = found["sda"], found["scl"]
        right = ",".join(f"{line}={channel}" for line, channel in found.items())
        raise BadReplay(f"{capture.path}: {swapped}; give --map {right}")
    return found


def _mapped(capture: Capture, text: str | None, session: bool) -> dict[str, str]:
    if text is not None:
        return _given(capture, text)
    for lines in (ALL, I2C, UART) if session else (I2C, UART):
        found = {line: channels_named(capture, line) for line in lines}
        if all(len(channels) == 1 for channels in found.values()):
            return {line: channels[0].name for line, channels in found.items()}
    raise BadReplay(
        f"{capture.path}: no channels named scl and sda, or rx; name them with --map scl=CHANNEL,sda=CHANNEL "
        f"or --map rx=CHANNEL; it has {listed(capture.channels)}"
    )


def serial_channel(capture: Capture, wanted: str | None) -> str:
    """Return the name of the channel for RX, or `wanted` unchanged if it is not None.

    wanted: the name or the index that the user gives. None: return the only channel of the capture, or else the channel
        named RX.

    Raise InputError if there is no such channel, or if several channels are named RX.
    """
    if wanted is not None:
        channels_given(capture, "--uart-file", f"rx={wanted}", {"rx": wanted}, LINES)
        return wanted
    if len(capture.channels) == 1:
        return capture.channels[0].name
    lines = channels_named(capture, "rx")
    if len(lines) == 1:
        return lines[0].name
    raise BadReplay(
        f"{capture.path}: which channel is RX? give --uart-file FILE,rx=CHANNEL; it has {listed(capture.channels)}"
    )


def _given(capture: Capture, text: str) -> dict[str, str]:
    given = pairs_given("--map", text, ALL)
    channels_given(capture, "--map", text, given, LINES)
    if set(given) not in (set(I2C), set(UART), set(ALL)):
        raise BadReplay(f"--map {text}: expected scl and sda, or rx, or all three; found {', '.join(given)}")
    return given

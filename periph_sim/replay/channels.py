"""Assignment of a capture's channels to the lines SCL, SDA and RX, by a text (`scl=0,sda=1`) or by the channels' names.

An I2C capture has scl and sda, a UART capture has only rx, and a capture of a session has all three.
"""

from __future__ import annotations

from ..core.phrases import did_you_mean
from ..traces.capture.capture import Capture, listed
from ..traces.capture.channel_names import channels_named
from ..traces.decode.i2c_table import swapped_lines
from . import BadReplay

I2C, UART = ("scl", "sda"), ("rx",)
ALL = (*I2C, *UART)


def channel_map(capture: Capture, text: str | None, session: bool = False) -> dict[str, str]:
    """Return the name of the channel for each line: scl and sda, or rx, or all three.

    text: the assignment that the user gives, such as "scl=0,sda=1". None: find the channels by their names; SCL and SDA
        are preferred to RX.
    session: used if `text` is None. True: return all three lines if the capture has them.

    Raise BadReplay if there are no such channels, if `text` is wrong, or if SCL and SDA are swapped.
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


def serial_channel(capture: Capture, text: str | None) -> str:
    """Return the name of the channel for RX.

    text: "rx=CHANNEL". None: return the only channel of the capture, or else the channel named RX.

    Raise BadReplay if there is no such channel, or if several channels are named RX.
    """
    if text is None and len(capture.channels) == 1:
        return capture.channels[0].name
    if text is None:
        lines = channels_named(capture, "rx")
        if len(lines) == 1:
            return lines[0].name
        raise BadReplay(
            f"{capture.path}: which channel is RX? give --uart-file FILE,rx=CHANNEL; it has {listed(capture.channels)}"
        )
    lines_given = _given(capture, text, "--uart-file")
    if set(lines_given) != set(UART):
        raise BadReplay(f"--uart-file {capture.path},{text}: expected rx=CHANNEL alone")
    return lines_given["rx"]


def _given(capture: Capture, text: str, option: str = "--map") -> dict[str, str]:
    found: dict[str, str] = {}
    for part in text.split(","):
        line, equals, wanted = (piece.strip() for piece in part.partition("="))
        line = line.lower()
        if not equals or not wanted:
            raise BadReplay(f"{option} {text!r}: expected scl=CHANNEL,sda=CHANNEL or rx=CHANNEL")
        if line not in I2C + UART:
            raise BadReplay(f"{option} {text!r}: there is no line {line!r}; {did_you_mean(line, I2C + UART)}")
        try:
            capture.channel(wanted)
        except LookupError:
            raise BadReplay(
                f"{option} {text!r}: {capture.path} has no single channel {wanted!r}; it has {listed(capture.channels)}"
            ) from None
        found[line] = wanted
    if set(found) not in (set(I2C), set(UART), set(ALL)):
        raise BadReplay(f"{option} {text!r}: expected scl and sda, or rx, or all three; found {', '.join(found)}")
    if len({capture.channel(channel).index for channel in found.values()}) < len(found):
        raise BadReplay(
            f"{option} {text!r}: one channel cannot be both lines; {capture.path} has {listed(capture.channels)}"
        )
    return found

"""The host unit, a separate program that sends host frames to a serial port.

The values of the frames come from a recorded flight (a CSV file) or from UDP datagrams. A datagram of 12 bytes is sent
as it is.

    flight.csv --motion--> MotionFrames --.
                                           +--> frame n, n periods after the first --> port
    Simulink --UDP--> latest datagram ----'

The port is any port that pyserial can open: a real port, the pseudo-terminal of `serve`, rfc2217://, f28335://. While
the program waits for the next frame, it reads and counts the bytes that arrive at the port. A frame has 12 bytes, with
the encoding of the [host] table of a case (see `host_frame`).
"""

from __future__ import annotations

import socket
import struct
import time
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from math import isfinite
from pathlib import Path
from typing import Any

from ..outside.errors import OutsideError
from ..outside.live.pacing import Pacer
from .host_frame import Encoding, MotionFrames
from .host_frames import VALUES, encode
from .motion import BadMotion
from .motion.flight import Settings, motion

NANOSECONDS = 10**9
AT_ONCE = 4096  # maximum number of bytes that are read from the port at a time
LONGEST = 1 << 16  # maximum number of bytes of a datagram
KINDS = {VALUES * 8: "d", VALUES * 4: "f"}  # maps the number of bytes of a datagram to the `struct` format of a value
OTHERS = "six doubles (48 bytes), six singles (24) or a frame as it is (12)"


class FlightFrames:
    """The frames of a flight in a CSV file. Raise BadMotion or BadCapture if the file is invalid.

    encoding: the encoding of the values.
    period: the time between two frames in seconds.
    """

    def __init__(self, file: Path, encoding: Encoding, period: Fraction) -> None:
        flight = motion(Settings(file))
        self._last = int(Fraction(flight.ends) / period)
        self._values = MotionFrames(flight, encoding, Fraction(0), period)

    def frame(self, number: int) -> bytes:
        """Return the bytes of frame `number`."""
        return encode(self._values(number), self._values.encoding.byte_order)

    def over(self, number: int) -> bool:
        """Return True if the flight has ended before frame `number`."""
        return number > self._last


class UdpFrames:
    """Frames with the values of the latest datagram: phi, theta, psi in rad, and ax, ay, az in g.

    order: the byte order of the values in datagrams, "little" or "big". A datagram of 12 bytes is a frame as it is.
    notify: a function that is called with a message at the first invalid datagram.
    refused: the number of invalid datagrams, which are ignored.
    held: the number of frames that repeat the previous frame, because no valid datagram has arrived in between.

    Raise OutsideError if the UDP port cannot be used.
    """

    def __init__(self, address: str, port: int, encoding: Encoding, order: str, notify: Callable[[str], None]) -> None:
        self.refused = self.held = 0
        self._encoding = encoding
        self._order = "<" if order == "little" else ">"
        self._notify = notify
        self._frame: bytes | None = None
        self._socket = socket.socket(socket.AF_INET6 if ":" in address else socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind((address, port))
        except (OSError, OverflowError) as error:
            self._socket.close()
            what = getattr(error, "strerror", None) or error
            raise OutsideError(f"port {port} of {address}: {what}; give another one") from None
        self._socket.setblocking(False)
        self.port: int = self._socket.getsockname()[1]

    def close(self) -> None:
        self._socket.close()

    def frame(self, number: int) -> bytes | None:
        """Return a frame with the values of the latest valid datagram; None before the first valid datagram."""
        latest = self._latest()
        if latest is None:
            self.held += self._frame is not None
        else:
            self._frame = latest
        return self._frame

    def over(self, number: int) -> bool:
        return False

    def _latest(self) -> bytes | None:
        """Return the frame of the last valid datagram since the previous call; None if no valid datagram arrived."""
        found = None
        while True:
            try:
                data = self._socket.recv(LONGEST)
            except BlockingIOError:
                return found
            except OSError:  # The error belongs to a single datagram, which is skipped.
                continue
            try:
                found = self._framed(data)
            except BadMotion as error:
                self.refused += 1
                if self.refused == 1:
                    self._notify(f"a datagram was refused: {error}")

    def _framed(self, data: bytes) -> bytes:
        if len(data) == 2 * VALUES:
            return data
        if len(data) not in KINDS:
            raise BadMotion(f"it has {len(data)} bytes; expected {OTHERS}")
        values = struct.unpack(f"{self._order}{VALUES}{KINDS[len(data)]}", data)
        if not all(map(isfinite, values)):
            raise BadMotion("a value is infinite or no number")
        counts, _ = self._encoding.counts(values)
        return encode(counts, self._encoding.byte_order)


@dataclass
class SentCounts:
    """Counts of the frames that the host unit has sent, and of the bytes that it has received.

    frames: the number of frames sent.
    came: the number of bytes received.
    """

    frames: int = 0
    came: int = 0


def send_frames(
    port: Any,
    source: FlightFrames | UdpFrames,
    period: Fraction,
    pacer: Pacer,
    frames: int | None = None,
    stopped: Callable[[], bool] = lambda: False,
) -> SentCounts:
    """Send frames until `frames` frames were sent, the source has ended, or `stopped` returns True.

    While the function waits for the next frame, it reads from the port. If the port is simulated, reading also advances
    its time.

    A UdpFrames source has no frame before its first datagram. Nothing is sent in the periods until then.

    period: the time between two frames in seconds.
    pacer: the object that returns the time until a frame is due, and records how late frames are. Its ticks are
        nanoseconds.
    frames: the maximum number of frames; None for no limit.
    """
    sent = SentCounts()
    number = 0
    while (frames is None or sent.frames < frames) and not source.over(number) and not stopped():
        due = int(number * period * NANOSECONDS)
        left = pacer.wait(due)
        while left > 0 and not stopped():
            port.timeout = left
            sent.came += len(port.read(AT_ONCE))
            left = pacer.wait(due)
        data = source.frame(number)
        number += 1
        if data is not None:
            port.write(data)
            sent.frames += 1
            pacer.reached(due)
    port.flush()
    return sent


def pacer_for(port: Any) -> Pacer:
    """Return a pacer that uses the clock of a simulated port, or the computer's clock for any other port."""
    return Pacer(NANOSECONDS, Fraction(1), "slip", getattr(port, "clock", time.monotonic))

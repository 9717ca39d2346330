"""The serial protocol of an I2CDriver, without a port. The client's bytes become transfers, and answers are returned.

    client --'s' 0xD0, 0xC0 0x00, 'p' ...--> I2cDriver --start, write, stop--> Master --> SDA, SCL
           <--reports, bytes----------------------

The I2CDriver is an adapter with a serial port for a PC (i2cdriver.com). Programs for it run unmodified. Its commands,
and their effects or answers:

    s ADDRESS+R/W    START: report              e BYTE    the same byte             ?   status, 80 characters
    0xC0+n-1 DATA    n bytes written: report    1, 4      100, 400 kHz              J   introspection, 80 characters
    0x80+n-1         n bytes, the last NACKed   u MASK    pull-ups, stored          c   capture until any byte
    a N              N bytes, all ACKed         x         bus reset: byte L         b   lines set, until '@'
    r DEV REG N      register read, with STOP   d         112 reports of a scan     m   monitor until any byte
    p                STOP                       i         lines released            f   'X' (display, not modelled)
    _                restart, as at power-on
    any other byte   nothing

A report is the byte 0x30 plus 1 for ACK, 2 for a time-out, and 4 for lost arbitration. The byte L is 0x30 plus 1 if
SCL is high, and 2 if SDA is high. N = 0 means 256.

Source: the I2CDriver's firmware (github.com/jamesbowman/i2cdriver, firmware/main.fs and capture.fs).

Chosen: the status states 5 V, 0 mA, 25 degrees. The checksum covers all bytes on the bus, addresses included. A
line that `b` would drive high is released, because the bus is open drain. The commands 'v' BYTE and 'w', which test
pull-ups, do nothing. If a line is held low for more than 25 ms, reports have the time-out bit until the next START, 'x'
or '_'.
"""

from __future__ import annotations

from binascii import crc_hqx
from collections.abc import Callable, Generator
from typing import TypeVar

from ...bus.i2c.monitor import I2cMonitor
from ...bus.i2c.transfer import Transfer
from ..errors import ArbitrationLost, OutsideError
from ..i2c_master import Master
from ..session import Session

Service = Generator[None, int, None]  # a generator to which each byte of the client is sent
Returned = TypeVar("Returned")

ACK, TIMEOUT, LOST = 1, 2, 4  # bits of a report
SCAN = range(0x08, 0x78)
MOST = 64  # maximum number of data bytes of a command
NOBODY = 0xFF  # the byte that a read without a transfer or with an error returns, as if no party drove SDA
INFORMATION = 80  # number of characters of the status and the introspection, with their brackets
A_BYTE = "10 us"  # time of a byte on the adapter's serial port, at 1 Mbaud
# The tokens of a capture. A byte and its acknowledge bit are nine bits, which become three tokens, in the order of the
# bits. Each of these tokens is BITS plus the value of three bits.
START, STOP, BITS = 1, 2, 8
WIRES = ("SDA", "SCL")


class I2cDriver:
    """The adapter on the bus of a session.

    pause: the number of ticks before each START, because a client's own pauses do not advance simulated time.
    """

    def __init__(self, session: Session, pause: int) -> None:
        self._session = session
        self._master: Master = session.i2c
        self._pause = pause
        self._said = bytearray()
        self._simple: dict[int, Callable[[], object]] = {
            ord("1"): lambda: self._set_rate(100),
            ord("4"): lambda: self._set_rate(400),
            ord("?"): lambda: self._say_text(self._status()),
            ord("J"): lambda: self._say_text(" ".join(["0"] * 18)),
            ord("d"): self._scan,
            ord("f"): lambda: self._say(ord("X")),
            ord("i"): self._master.let_go,
            ord("p"): self._stop,
            ord("x"): self._reset,
            ord("_"): self._boot,
        }
        self._transfers: list[Transfer] = []
        self._monitor: I2cMonitor | None = None
        self._boot()
        self._service = self._serve()
        self.next_client()

    def next_client(self) -> None:
        """Discard the command that the previous client has not completed, and end its capture."""
        self._service.close()
        self._service = self._serve()
        next(self._service)
        self.capturing = False
        self._transfers.clear()

    def receive(self, data: bytes) -> bytes:
        """Execute the commands in these bytes of the client, and return the answers."""
        for byte in data:
            self._service.send(byte)
        said, self._said = bytes(self._said), bytearray()
        return said

    def captured(self) -> bytes:
        """Return the traffic on the bus since the last call, in the format of the command 'c'; b"" if there is none."""
        tokens = [token for transfer in self._transfers for token in _tokens(transfer)]
        self._transfers.clear()
        tokens += [0] * (len(tokens) % 2)
        return bytes(high << 4 | low for high, low in zip(tokens[::2], tokens[1::2], strict=True))

    # Commands -------------------------------------------------------------------------

    def _serve(self) -> Service:
        while True:
            command = yield
            count = (command & MOST - 1) + 1
            if command >= 0xC0:
                data = bytearray()
                while len(data) < count:
                    data.append((yield))
                self._report([self._write(byte) for byte in data][-1])
            elif command >= 0x80:
                self._say(*(self._read(ack=place + 1 < count) for place in range(count)))
            elif command == ord("s"):
                self._report(self._start((yield)))
            elif command == ord("a"):
                count = (yield) or 256
                self._say(*(self._read(ack=True) for _ in range(count)))
            elif command == ord("r"):
                self._read_register((yield), (yield), (yield) or 256)
            elif command == ord("e"):
                self._say((yield))
            elif command == ord("u"):
                self._pull_ups = (yield) & 0x3F
            elif command == ord("b"):
                yield from self._bang()
            elif command == ord("c"):
                yield from self._capture()
            elif command in (ord("m"), ord("v")):
                # The byte after the command is ignored: the monitor's display and the pull-up test are not modelled.
                yield
            elif command in self._simple:
                self._simple[command]()

    def _boot(self) -> None:
        self._master.let_go()
        self._set_rate(100)
        self._pull_ups = 0b100100
        self._checksum = 0xFFFF
        self._trouble = 0

    def _set_rate(self, rate: int) -> None:
        self._rate = rate
        self._master.rate = f"{rate} kHz"

    def _scan(self) -> None:
        for address in SCAN:
            self._report(self._start(address << 1))
            self._stop()

    def _read_register(self, device: int, register: int, count: int) -> None:
        self._start(device << 1)
        self._write(register)
        self._start(device << 1 | 1)
        self._say(*(self._read(ack=place + 1 < count) for place in range(count)))
        self._stop()

    def _reset(self) -> None:
        self._trouble = 0
        self._master.clear()
        self._say(0x30 | self._lines())

    def _bang(self) -> Service:
        """Set the lines as each byte of the client states, up to the byte '@'.

        The bits of a byte, lowest first: drive SDA, SDA's level, drive SCL, SCL's level, report. The two bits that
        state which lines are driven are ignored: a line is released if its level is 1.
        """
        session = self._session
        self._master.let_go()
        while (bits := (yield)) != ord("@"):
            session.apply(session.now, {"SDA": bits >> 1 & 1, "SCL": bits >> 3 & 1})
            session.advance(session.now + session.ticks(A_BYTE))
            if bits & 0x10:
                self._say(self._session.level("SCL") << 1 | self._session.level("SDA"))
        self._master.let_go()

    def _capture(self) -> Service:
        self._master.let_go()
        if self._monitor is None:
            wires = self._session.scene.wires
            self._monitor = I2cMonitor(wires["SCL"], wires["SDA"], self._on_transfer, {})
        self.capturing = True
        yield
        self.capturing = False
        self._transfers.clear()

    def _on_transfer(self, transfer: Transfer) -> None:
        if self.capturing:
            self._transfers.append(transfer)

    # On the bus ---------------------------------------------------------------------------

    def _start(self, byte: int) -> bool:
        session, master = self._session, self._master
        session.advance(session.now + self._pause)
        self._trouble = 0
        acked = self._on_bus(lambda: master.start(byte >> 1, bool(byte & 1)))
        if acked is not None:
            self._count(byte)
        return bool(acked)

    def _write(self, byte: int) -> bool:
        acked = self._on_bus(lambda: self._master.write(byte)) if self._master.writes else None
        if acked is not None:
            self._count(byte)
        return bool(acked)

    def _read(self, ack: bool) -> int:
        byte = self._on_bus(lambda: self._master.read(ack)) if self._master.reads else None
        if byte is None:
            return NOBODY
        self._count(byte)
        return byte

    def _stop(self) -> None:
        if self._master.held:
            self._on_bus(self._master.stop)

    def _on_bus(self, call: Callable[[], Returned]) -> Returned | None:
        """Call a function that uses the bus, and return its result.

        After a time-out or lost arbitration, release the lines and return None. Reports contain the error until the
        next START, 'x' or '_'.
        """
        try:
            return call()
        except OutsideError as error:
            self._trouble = LOST if isinstance(error, ArbitrationLost) else TIMEOUT
            self._master.let_go()
            return None

    def _lines(self) -> int:
        return self._session.level("SDA") << 1 | self._session.level("SCL")

    # To the client ------------------------------------------------------------------------

    def _say(self, *values: int) -> None:
        self._said += bytes(values)

    def _say_text(self, text: str) -> None:
        self._said += f"[{text.ljust(INFORMATION - 2)}]".encode("ascii")

    def _report(self, acked: bool) -> None:
        self._say(0x30 | self._trouble | ACK * acked)

    def _status(self) -> str:
        seconds = self._session.now // self._session.ticks_per_second
        lines = f"{self._session.level('SDA')} {self._session.level('SCL')}"
        return (
            f"i2cdriver1 F28335 {seconds:09d} 5.000 000 25.0 I {lines} {self._rate} {self._pull_ups:02x}"
            f" {self._checksum:04x}"
        )

    def _count(self, byte: int) -> None:
        """Update the checksum with a byte of the bus: CRC-16/CCITT, most significant bit first."""
        self._checksum = crc_hqx(bytes([byte]), self._checksum)


def _tokens(transfer: Transfer) -> list[int]:
    tokens: list[int] = []
    for phase in transfer.phases:
        tokens.append(START)
        bytes_and_acks = [(phase.address << 1 | phase.read, phase.acked)]
        bytes_and_acks += zip(phase.got if phase.read else phase.data, phase.acks, strict=True)
        for byte, acked in bytes_and_acks:
            nine = byte << 1 | (not acked)
            tokens += [BITS | nine >> 6, BITS | nine >> 3 & 7, BITS | nine & 7]
    return [*tokens, STOP]

"""A session's bus as an object like CircuitPython's `busio.I2C`. A driver's calls become transfers on the wires.

Source: CircuitPython 9.2, shared-bindings, busio.I2C.
"""

from __future__ import annotations

import errno
from contextlib import AbstractContextManager
from types import TracebackType

from ..session import Session
from .i2c_dev import SmbusTransfer, on_bus

Buffer = bytearray | memoryview
ADDRESSES = range(0x08, 0x78)  # the 7-bit addresses that are not reserved


class I2C(AbstractContextManager["I2C"]):
    """A `busio.I2C` on the bus of a session. frequency: the frequency of SCL in Hz.

    pause: the simulated time that passes before each transfer, because a driver's `time.sleep` does not advance
        simulated time.

    The transfers raise OSError with the same codes as on hardware: ENODEV if the address is not acknowledged, EIO if a
    byte is not acknowledged, ETIMEDOUT if another party holds or wins the bus. An address above 0x7f is EINVAL.
    """

    def __init__(self, session: Session, frequency: int = 100_000, pause: str = "100 us") -> None:
        self._session = session
        session.i2c.rate = f"{frequency} Hz"
        self._pause = session.ticks(pause)
        self._locked = False

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.deinit()

    def try_lock(self) -> bool:
        """Lock the bus for the caller. Return False if it is locked already."""
        was_locked, self._locked = self._locked, True
        return not was_locked

    def unlock(self) -> None:
        self._locked = False

    deinit = unlock

    def scan(self) -> list[int]:
        """Return the addresses from 0x08 to 0x77 that a target on the bus acknowledges."""
        return [address for address in ADDRESSES if self._asks(address)]

    def writeto(self, address: int, buffer: bytes | Buffer, *, start: int = 0, end: int | None = None) -> None:
        self._transfer(address, bytes(buffer[start:end]), None)

    def readfrom_into(self, address: int, buffer: Buffer, *, start: int = 0, end: int | None = None) -> None:
        self._transfer(address, None, memoryview(buffer)[start:end])

    def writeto_then_readfrom(
        self,
        address: int,
        out_buffer: bytes | Buffer,
        in_buffer: Buffer,
        *,
        out_start: int = 0,
        out_end: int | None = None,
        in_start: int = 0,
        in_end: int | None = None,
    ) -> None:
        """Write `out_buffer`, and then read into `in_buffer` after a repeated START."""
        self._transfer(address, bytes(out_buffer[out_start:out_end]), memoryview(in_buffer)[in_start:in_end])

    def _asks(self, address: int) -> bool:
        try:
            self._transfer(address, b"", None)
        except OSError:
            return False
        return True

    def _transfer(self, address: int, data: bytes | None, into: memoryview | None) -> None:
        with on_bus(self._session, self._pause, errno.ETIMEDOUT) as master:
            bus = SmbusTransfer(master, address, refused=errno.ENODEV)
            if data is not None:
                bus.send(data)
            if into is not None:
                into[:] = bus.got(len(into))

"""The bytes of an SMBus transfer on a controller, and the packet error code (PEC) after them.

    S address W command [data ...] [PEC] P
    S address W command [data ...] Sr address R data ... [PEC] N P

The code is of every byte of the transfer, addresses included: CRC-8, x^8 + x^2 + x + 1.

Source: System Management Bus 3.2, sections 6.4 and 6.5; Linux 6.6 Documentation/i2c/smbus-protocol.rst
and fault-codes.rst.
"""

from __future__ import annotations

import errno
from collections.abc import Iterable

from ..i2c_master import Master

MOST_BLOCK = 32  # maximum number of bytes of a block
POLYNOMIAL = 0x107


class SmbusTransfer:
    """A transfer with one target. checks: True for a transfer with a packet error code.

    OSError, as from a kernel: ENXIO if the address is not acknowledged, EIO if a byte is not acknowledged, EBADMSG for
    a wrong code, EPROTO for a block of an invalid length.
    """

    def __init__(self, master: Master, address: int, checks: bool = False) -> None:
        self._master = master
        self._address = address
        self._checks = checks
        self._code = 0  # packet error code of the bytes so far

    def begin(self, reads: bool) -> None:
        """Send START, or repeated START, and the address."""
        if not self._master.start(self._address, reads):
            raise OSError(errno.ENXIO, f"address {self._address:#04x} was not acknowledged")
        self._add(self._address << 1 | reads)

    def send(self, data: Iterable[int], answered: bool = False) -> None:
        """Write bytes. answered: a read follows, which includes the code."""
        self.begin(reads=False)
        for byte in data:
            self._send(byte)
        if self._checks and not answered:
            self._send(self._code)

    def got(self, count: int) -> bytes:
        self.begin(reads=True)
        return self._got(count)

    def got_block(self) -> bytes:
        """Read a block, whose first byte states the number of bytes."""
        self.begin(reads=True)
        count = self._byte(ack=True)
        if not 1 <= count <= MOST_BLOCK:
            self._master.read(ack=False)
            raise OSError(errno.EPROTO, f"a block of {count} bytes was received; expected 1 to {MOST_BLOCK}")
        return self._got(count)

    def _got(self, count: int) -> bytes:
        data = bytes(self._byte(ack=self._checks or place + 1 < count) for place in range(count))
        if self._checks:
            right = self._code
            code = self._byte(ack=False)
            if code != right:
                raise OSError(errno.EBADMSG, f"received packet error code {code:#04x}; expected {right:#04x}")
        return data

    def _send(self, byte: int) -> None:
        if not self._master.write(byte):
            raise OSError(errno.EIO, f"a byte was not acknowledged at {self._address:#04x}")
        self._add(byte)

    def _byte(self, ack: bool) -> int:
        byte = self._master.read(ack)
        self._add(byte)
        return byte

    def _add(self, byte: int) -> None:
        code = self._code ^ byte
        for _ in range(8):
            code = code << 1 ^ (POLYNOMIAL if code & 0x80 else 0)
        self._code = code

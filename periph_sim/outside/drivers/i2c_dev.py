"""Files `/dev/i2c-N` that access sessions within a `with` block. Unmodified drivers, such as smbus2, can open them.

    os.open, open --unused file number-------> ioctl: address, SMBus transfer, messages --> Master --> SDA, SCL
                                               read, write: plain transfers

All other files work as usual. After the block, `/dev/i2c-N` accesses the computer's own buses again.

Source: Linux 6.6 Documentation/i2c/dev-interface.rst, smbus-protocol.rst and fault-codes.rst; include/uapi/linux/i2c.h
and i2c-dev.h.
"""

from __future__ import annotations

import builtins
import ctypes
import errno
import io
import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, ExitStack, contextmanager
from typing import Any
from unittest.mock import patch

from ..errors import ArbitrationLost, OutsideError
from ..i2c_master import Master
from ..session import Session

MOST_BLOCK = 32  # maximum number of data bytes of an SMBus block transfer
POLYNOMIAL = 0x107


class SmbusTransfer:
    """An SMBus transfer with one target. checks: True if the transfer has a packet error code (PEC).

        S address W command [data ...] [PEC] P                            S: START, Sr: repeated START
        S address W command [data ...] Sr address R data ... [PEC] N P    P: STOP, N: NACK

    The PEC covers all bytes of the transfer, addresses included: CRC-8, x^8 + x^2 + x + 1 (System Management Bus 3.2,
    sections 6.4 and 6.5).

    Raise OSError with the codes of the Linux kernel: EINVAL if the address is not 0 to 0x7f, ENXIO if the address is
    not acknowledged, EIO if a byte is not acknowledged, EBADMSG for a wrong PEC, EPROTO for a block of an invalid
    length.

    refused: the code for an address that is not acknowledged.
    """

    def __init__(self, master: Master, address: int, checks: bool = False, refused: int = errno.ENXIO) -> None:
        if address not in range(0x80):
            raise OSError(errno.EINVAL, f"address {address!r}: expected 0 to 0x7f")
        self._master = master
        self._address = address
        self._checks = checks
        self._refused = refused
        self._code = 0  # PEC of the bytes so far

    def begin(self, reads: bool) -> None:
        """Send a START, or a repeated START within a transfer, and the address."""
        if not self._master.start(self._address, reads):
            raise OSError(self._refused, f"address {self._address:#04x} was not acknowledged")
        self._add(self._address << 1 | reads)

    def send(self, data: Iterable[int], answered: bool = False) -> None:
        """Write bytes. answered: True if a read follows; the target then sends the PEC at the end of the read."""
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


@contextmanager
def on_bus(session: Session, pause: int, lost: int = errno.EAGAIN) -> Iterator[Master]:
    """Yield the controller of a session for one transfer. At the end, or after an error, send a STOP if SCL is held.

    pause: the number of ticks that pass before the transfer.
    lost: the code of the OSError for lost arbitration.

    Raise OSError with ETIMEDOUT for any other OutsideError, normally because another party holds the bus.
    """
    session.advance(session.now + pause)
    try:
        try:
            yield session.i2c
        finally:
            if session.i2c.held:
                session.i2c.stop()
    except ArbitrationLost as error:
        raise OSError(lost, str(error)) from None
    except OutsideError as error:
        raise OSError(errno.ETIMEDOUT, str(error)) from None


RETRIES, TIMEOUT = 0x701, 0x702
SLAVE, TENBIT, FUNCS, SLAVE_FORCE, RDWR, PEC, SMBUS = 0x703, 0x704, 0x705, 0x706, 0x707, 0x708, 0x720
QUICK, BYTE, BYTE_DATA, WORD_DATA, PROC_CALL, BLOCK_DATA, BLOCK_PROC_CALL, I2C_BLOCK = 0, 1, 2, 3, 4, 5, 7, 8
FUNCTIONS = 0x1 | 0x8 | 0x8000 | 0x0FFF_0000  # I2C_FUNC bits: plain I2C, PEC, block process call, all SMBus transfers
READS = 1  # value of `read_write` for a read, and flag of a message that reads
FIRST_FILE = 1 << 20  # file number of the first open `/dev/i2c-N`; the process's other file numbers are lower


class _SmbusRequest(ctypes.Structure):  # struct i2c_smbus_ioctl_data
    _fields_ = [
        ("read_write", ctypes.c_uint8),
        ("command", ctypes.c_uint8),
        ("size", ctypes.c_uint32),
        ("data", ctypes.POINTER(ctypes.c_uint8 * (MOST_BLOCK + 2))),
    ]


class _Message(ctypes.Structure):  # struct i2c_msg
    _fields_ = [
        ("address", ctypes.c_uint16),
        ("flags", ctypes.c_uint16),
        ("length", ctypes.c_uint16),
        ("data", ctypes.POINTER(ctypes.c_uint8)),
    ]


class _Messages(ctypes.Structure):  # struct i2c_rdwr_ioctl_data
    _fields_ = [("messages", ctypes.POINTER(_Message)), ("count", ctypes.c_uint32)]


class Adapter(io.RawIOBase):
    """An open file `/dev/i2c-N`. `open` returns it as an unbuffered file object.

    number: the file number.
    pause: the number of ticks that pass before each transfer.
    """

    def __init__(self, number: int, session: Session, pause: int) -> None:
        self._number = number
        self._session = session
        self._pause = pause
        self._address = -1
        self._checks = False  # True if transfers have a PEC

    def ioctl(self, request: int, argument: Any) -> int:
        if request in (SLAVE, SLAVE_FORCE):
            if not 0 <= int(argument) < 0x80:
                raise OSError(errno.EINVAL, f"address {argument}: expected 0 to 0x7f")
            self._address = int(argument)
        elif request == FUNCS:
            size = ctypes.sizeof(argument)  # the argument is an unsigned long, but some programs pass an int
            ctypes.memmove(ctypes.addressof(argument), FUNCTIONS.to_bytes(size, sys.byteorder), size)
        elif request == TENBIT and int(argument):
            raise OSError(errno.EINVAL, "this adapter does not support ten-bit addresses")
        elif request == PEC:
            self._checks = bool(int(argument))
        elif request in (TENBIT, RETRIES, TIMEOUT):
            pass  # TENBIT is 0, the default. There are no retries, and the time-out of a held bus is always 25 ms
        elif request == SMBUS:
            with self._on_bus() as master:
                self._smbus(master, _SmbusRequest.from_address(ctypes.addressof(argument)))
        elif request == RDWR:
            with on_bus(self._session, self._pause) as master:
                self._messages(master, _Messages.from_address(ctypes.addressof(argument)))
        else:
            raise OSError(errno.ENOTTY, f"no request of an I2C adapter: {request:#x}")
        return 0

    def fileno(self) -> int:
        return self._number

    def readable(self) -> bool:
        return True

    def writable(self) -> bool:
        return True

    def write(self, data: Any) -> int:
        with self._on_bus() as master:
            SmbusTransfer(master, self._address).send(bytes(data))
        return len(data)

    def readinto(self, buffer: Any) -> int:
        with self._on_bus() as master:
            buffer[:] = SmbusTransfer(master, self._address).got(len(buffer))
        return len(buffer)

    def _on_bus(self) -> AbstractContextManager[Master]:
        """Return a context for a transfer with the target whose address was set. Raise OSError if none was set."""
        if self._address < 0:
            raise OSError(errno.EINVAL, "no address was given")
        return on_bus(self._session, self._pause)

    def _smbus(self, master: Master, asked: _SmbusRequest) -> None:
        reads, command, size = asked.read_write == READS, asked.command, asked.size
        bus = SmbusTransfer(master, self._address, self._checks and size not in (QUICK, I2C_BLOCK))
        data = asked.data.contents if asked.data else (ctypes.c_uint8 * (MOST_BLOCK + 2))()
        if size == QUICK:
            bus.begin(reads)
        elif size == BYTE and reads:
            data[0] = bus.got(1)[0]
        elif size == BYTE:
            bus.send([command])
        elif size in (BYTE_DATA, WORD_DATA, PROC_CALL):
            length = 1 if size == BYTE_DATA else 2
            answered = reads or size == PROC_CALL
            bus.send([command, *(data[:length] if not reads or size == PROC_CALL else [])], answered)
            if answered:
                data[:length] = list(bus.got(length))
        elif size in (BLOCK_DATA, BLOCK_PROC_CALL, I2C_BLOCK):
            self._block(bus, size, command, reads, data)
        else:
            raise OSError(errno.EOPNOTSUPP, f"no SMBus transfer: {size}")

    def _block(self, bus: SmbusTransfer, size: int, command: int, reads: bool, data: Any) -> None:
        length = data[0]
        if (not reads or size != BLOCK_DATA) and not 1 <= length <= MOST_BLOCK:
            raise OSError(errno.EINVAL, f"a block of {length} bytes; expected 1 to {MOST_BLOCK}")
        sends, answered = not reads or size == BLOCK_PROC_CALL, reads or size == BLOCK_PROC_CALL
        counted = [length] if size != I2C_BLOCK else []
        bus.send([command, *(counted + data[1 : 1 + length] if sends else [])], answered)
        if answered:
            got = bus.got(length) if size == I2C_BLOCK else bus.got_block()
            data[: 1 + len(got)] = [len(got), *got]

    def _messages(self, master: Master, asked: _Messages) -> None:
        for message in asked.messages[: asked.count]:
            if message.flags & ~READS:
                raise OSError(errno.EOPNOTSUPP, f"flags {message.flags:#x} of a message; only reading is one here")
            bus = SmbusTransfer(master, message.address)
            if message.flags & READS:
                for place, byte in enumerate(bus.got(message.length)):
                    message.data[place] = byte
            else:
                bus.send(message.data[: message.length])


@contextmanager
def i2c_dev(sessions: Mapping[int, Session], pause: str = "100 us") -> Iterator[None]:
    """Let `/dev/i2c-N` access the bus of the session `sessions[N]` within a `with` block. This requires Linux.

    pause: the simulated time that passes before each transfer, because a driver's `time.sleep` does not advance
        simulated time.

    Access raises OSError with the codes of the Linux kernel: ENXIO if the address is not acknowledged, EIO if a byte is
    not acknowledged, ETIMEDOUT if another party holds the bus, EAGAIN if arbitration is lost, ENOENT if `sessions` has
    no entry N, EINVAL, EOPNOTSUPP or ENOTTY for invalid requests, and those of `SmbusTransfer`.
    """
    import fcntl

    adapters: dict[int, Adapter] = {}
    real_open, real_close, real_read, real_write, real_ioctl = os.open, os.close, os.read, os.write, fcntl.ioctl
    real_builtin = builtins.open

    def ours(path: Any) -> bool:
        return isinstance(path, str | os.PathLike) and str(os.fspath(path)).startswith("/dev/i2c-")

    def opened(path: Any, *more: Any, **named: Any) -> int:
        if not ours(path):
            return real_open(path, *more, **named)
        text = str(os.fspath(path))
        number = text.removeprefix("/dev/i2c-")
        if not number.isdecimal() or int(number) not in sessions:
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), text)
        session = sessions[int(number)]
        file = FIRST_FILE + len(adapters)
        adapters[file] = Adapter(file, session, session.ticks(pause))
        return file

    def opened_by_python(path: Any, *more: Any, **named: Any) -> Any:
        return adapters[opened(path)] if ours(path) else real_builtin(path, *more, **named)

    def ioctl(file: Any, request: int, argument: Any = 0, *more: Any) -> Any:
        number = file.fileno() if isinstance(file, Adapter) else file
        adapter = adapters.get(number) if isinstance(number, int) else None
        return adapter.ioctl(request, argument) if adapter else real_ioctl(file, request, argument, *more)

    def closed(file: int) -> None:
        if file not in adapters:
            real_close(file)

    def read(file: int, count: int) -> bytes | None:
        return adapters[file].read(count) if file in adapters else real_read(file, count)

    def write(file: int, data: Any) -> int:
        return adapters[file].write(data) if file in adapters else real_write(file, data)

    openers = [module for module in (builtins, io) if getattr(module, "open", None) is real_builtin]
    importers = [module for module in list(sys.modules.values()) if getattr(module, "ioctl", None) is real_ioctl]
    with ExitStack() as patches:
        for name, stands_in in (("open", opened), ("close", closed), ("read", read), ("write", write)):
            patches.enter_context(patch.object(os, name, stands_in))
        for module in openers:
            patches.enter_context(patch.object(module, "open", opened_by_python))
        for module in importers:
            patches.enter_context(patch.object(module, "ioctl", ioctl))
        yield

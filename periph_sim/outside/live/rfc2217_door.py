"""A serial line over TCP, by RFC 2217. A client sends and receives bytes, and sets the rate and format of the line.

    client, rfc2217://127.0.0.1:4000 --TCP--> PortManager --bytes--> SerialLine --bits--> RX
                                              baud, format, break --^

pyserial's PortManager implements Telnet. There is one client at a time. A second client receives a message with the
address of the first client and is disconnected. A client that sends invalid Telnet is disconnected, too, but its
earlier bytes are still sent. A program without RFC 2217, such as netcat, uses the line with its present rate and
format.

Source: RFC 2217; RFC 854; pyserial 3.5, serial.rfc2217.PortManager.
"""

from __future__ import annotations

import select
import socket
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

from ..errors import OutsideError
from ..serial_line import SerialLine, port_settings
from .backlog import AT_ONCE, MOST, Backlog, left_there

LOOPBACK = "127.0.0.1"
WHILE = 0.05  # a closing door reads a client's last bytes until no more arrive for this time, in seconds
LONGEST_OPTION = 256  # maximum number of bytes of a Telnet subnegotiation; RFC 2217's settings have at most six
# A client whose computer no longer answers is disconnected after 25 s: 10 s without data, and three probes of 5 s each.
KEEPALIVE = {"TCP_KEEPIDLE": 10, "TCP_KEEPINTVL": 5, "TCP_KEEPCNT": 3}


class Rfc2217Door:
    """TCP server for one serial line. Raise OutsideError if it cannot listen at the port, or if pyserial is missing.

    port: the TCP port; 0 for any free port.
    address: the address at which the server listens. By default, only clients on this computer can connect.
    notify: callback that receives a sentence when a client connects, is rejected or disconnects.
    """

    def __init__(
        self,
        line: SerialLine,
        baud: int,
        form: str,
        port: int,
        address: str = LOOPBACK,
        notify: Callable[[str], None] = lambda sentence: None,
    ) -> None:
        try:
            import serial.rfc2217
        except ImportError:
            raise OutsideError("RFC 2217 needs pyserial: pip install 'periph-sim[live]'") from None
        self._manager_of = serial.rfc2217.PortManager
        self._line = line
        self._port = ManagedPort(line, baud, form, self)
        self._notify = notify
        self.back = Backlog()
        self.unread = 0  # number of bytes from a client that were not read when the door was closed
        self._client: Client | None = None
        try:
            self._listener = socket.create_server((address, port))
        except (OSError, OverflowError) as error:
            what = str(getattr(error, "strerror", None) or error).partition(" (while ")[0]
            raise OutsideError(f"port {port} of {address}: {what}; give another one") from None
        self._listener.setblocking(False)
        self.path = "rfc2217://{}:{}".format(*self._listener.getsockname()[:2])

    def close(self) -> None:
        if self._client is not None:
            self.unread += left_there(self._client.receive_rest)
            self._client.close()
        self._listener.close()

    def files(self) -> Sequence[int]:
        listens = [self._listener.fileno()]
        reads = self._client is not None and self._line.waiting < MOST
        return [*listens, self._client.file] if self._client is not None and reads else listens

    def turn(self) -> None:
        self._welcome()
        self.back.add(self._line.read())
        client = self._client
        if client is None:
            return
        try:
            while self._line.waiting < MOST and client.receive():
                pass
            client.send(self.back)
        except ClientDisconnected as gone:
            self._let_go(client, str(gone))

    def _let_go(self, client: Client, why: str) -> None:
        self._notify(f"{client.name} {why}")
        client.close()
        self._client = None
        self._line.hold_break(False)

    def _welcome(self) -> None:
        try:
            connection, address = self._listener.accept()
        except BlockingIOError:
            return
        except OSError as error:
            self._notify(f"a client could not be accepted: {error.strerror}")
            return
        name = f"client {address[0]}:{address[1]}"
        connection.setblocking(False)
        # A new client replaces a client that has disconnected. Unread bytes of the old client are discarded.
        if self._client is not None and self._client.closed():
            self._let_go(self._client, "left")
        if self._client is not None:
            with connection, suppress(OSError):  # OSError: the client has disconnected already
                said = f"this SCI has a client already, {self._client.name.removeprefix('client ')}; close that first"
                connection.send(f"{said}\r\n".encode())
            self._notify(f"{name} was rejected: {self._client.name} has the line")
            return
        discarded = self._line.next_client()
        self._client = Client(connection, name, self._line, self._port, self._manager_of)
        of_before = f"; {discarded} unsent bytes of the one before are discarded" if discarded else ""
        self._notify(f"{name} connected{of_before}")


class ClientDisconnected(Exception):
    """A client has disconnected, or must be disconnected. The message continues a sentence that begins "client X"."""


class Client:
    """The connection to a client, which separates data and Telnet commands in the received bytes."""

    def __init__(
        self, connection: socket.socket, name: str, line: SerialLine, port: ManagedPort, manager_of: Any
    ) -> None:
        self.name = name
        self.file = connection.fileno()
        self._connection = connection
        self._line = line
        self._out = bytearray()  # bytes to send to the client, Telnet commands included
        self._data = bytearray()  # bytes received from the client, without Telnet commands
        port.before = self._put
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        for option, value in KEEPALIVE.items():
            if hasattr(socket, option):
                connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, option), value)
        self._manager = manager_of(port, self)

    def close(self) -> None:
        self._connection.close()

    def closed(self) -> bool:
        """Return True if the client has closed its connection or vanished, even if its last bytes are unread.

        On Windows, a connection with unread bytes counts as open.
        """
        if not hasattr(select, "poll"):
            try:
                return bool(select.select([self.file], [], [], 0)[0]) and not self._connection.recv(1, socket.MSG_PEEK)
            except OSError:
                return True
        poll = select.poll()
        poll.register(self.file, getattr(select, "POLLRDHUP", 0))
        return bool(poll.poll(0))

    def receive_rest(self) -> bytes:
        """Return unread bytes, Telnet commands included.

        Return b"" if none arrives within WHILE seconds, or if the connection is closed.
        """
        try:
            return self._connection.recv(MOST) if select.select([self.file], [], [], WHILE)[0] else b""
        except (OSError, ValueError):  # ValueError: the connection is closed
            return b""

    def write(self, data: bytes) -> None:
        """Queue Telnet answers to the client. The PortManager calls this."""
        self._out += data

    def receive(self) -> bool:
        """Process received data and commands. Return False if nothing has arrived.

        Raise ClientDisconnected if the client has closed the connection, or must be disconnected.
        """
        try:
            came = self._connection.recv(AT_ONCE)
        except BlockingIOError:
            return False
        except OSError as error:
            raise ClientDisconnected(f"vanished: {error.strerror}") from None
        if not came:
            raise ClientDisconnected("left")
        try:
            for byte in self._manager.filter(came):
                self._data += byte
        except Exception as error:  # pyserial's parser raises arbitrary exceptions
            raise ClientDisconnected(f"sent invalid RFC 2217 ({error!r}), and was disconnected") from None
        finally:
            self._put()
        if len(self._manager.suboption or b"") > LONGEST_OPTION:
            raise ClientDisconnected(f"sent a Telnet option of more than {LONGEST_OPTION} bytes, and was disconnected")
        if len(self._out) > MOST:
            raise ClientDisconnected("requested Telnet options faster than it read the answers, and was disconnected")
        return True

    def _put(self) -> None:
        """Write received data to the line. Commands that change the line's settings call this first."""
        self._line.write(bytes(self._data))
        self._data.clear()

    def send(self, back: Backlog) -> None:
        """Send Telnet answers, and then bytes from the SCI, until the client accepts no more."""
        self._send()
        while not self._out and (data := back.read(AT_ONCE)):
            self._out += b"".join(self._manager.escape(data))
            self._send()

    def _send(self) -> None:
        try:
            while self._out:
                del self._out[: self._connection.send(self._out[:AT_ONCE])]
        except BlockingIOError:
            return
        except OSError as error:
            raise ClientDisconnected(f"vanished: {error.strerror}") from None


def _setting(name: str) -> property:
    """Return the property of a ManagedPort that reads and changes one of its settings."""
    return property(lambda port: port.settings[name], lambda port, value: port.change(name, value))


class ManagedPort:
    """The port that a PortManager controls. An unsupported rate or format raises ValueError.

    The attributes of modem lines and flow control have no effect. An SCI has no modem lines, and TCP's flow control
    delays a client that sends faster than the line.

    settings: the rate and the format of the line, with the names and values of pyserial.
    """

    xonxoff = rtscts = cts = dsr = ri = cd = False
    rts = dtr = True

    def __init__(self, line: SerialLine, baud: int, form: str, door: Rfc2217Door) -> None:
        self.before: Callable[[], None] = lambda: None  # called before each change of rate, format or break
        self.settings = port_settings(baud, form)
        self._line = line
        self._door = door

    def change(self, name: str, value: Any) -> None:
        """Change one of the settings of the line. Raise OutsideError, and change nothing, if the value is invalid."""
        self.before()
        changed = self.settings | {name: value}
        self._line.set(changed["baudrate"], "{bytesize}{parity}{stopbits:g}".format_map(changed))
        self.settings = changed

    baudrate, bytesize, parity, stopbits = map(_setting, ("baudrate", "bytesize", "parity", "stopbits"))

    @property
    def break_condition(self) -> bool:
        return self._line.broken

    @break_condition.setter
    def break_condition(self, on: bool) -> None:
        self.before()
        self._line.hold_break(on)

    def reset_input_buffer(self) -> None:
        self._door.back.add(self._line.read())
        self._door.back.clear()

    def reset_output_buffer(self) -> None:
        """Do nothing, because bytes cannot be taken back from the line's queue."""

"""Messages for errors of serial ports, from exceptions of pyserial or of the system."""

from __future__ import annotations

import errno

HELD = "another program has it open; close it there first"
FORBIDDEN = "no permission to open it; join the group that has it, often dialout"
GONE = "it is gone: unplugged, closed at its other end, or read by another program, too"
NO_PORT = "it is no serial port"
USED = ("read failed", "write failed", "device reports readiness")  # pyserial's messages about a port that was open
WHY = {
    errno.ENOENT: "there is no such port",
    errno.ENXIO: "there is no such port",
    errno.ENODEV: "there is no such port",
    errno.EACCES: FORBIDDEN,
    errno.EPERM: FORBIDDEN,
    errno.EAGAIN: HELD,
    errno.EBUSY: HELD,
    errno.ENOTTY: NO_PORT,
    errno.EISDIR: NO_PORT,
    errno.ECONNREFUSED: "no server is listening; start it first",
}


def in_our_words(port: str, error: BaseException) -> str:
    """Return "PORT: reason". Other errors keep the text of the system or pyserial."""
    text = str(error)
    if (isinstance(error, OSError) and error.errno == errno.EIO) or text.startswith(USED):
        return f"{port}: {GONE}"
    if text.startswith("Could not configure port"):
        return f"{port}: {NO_PORT}"
    cause: BaseException | None = error
    while cause is not None:
        if isinstance(cause, OSError) and cause.errno in WHY:
            return f"{port}: {WHY[cause.errno]}"
        cause = None if cause.__suppress_context__ else cause.__context__
    return text if text.startswith(port) else f"{port}: {text}"

"""What went wrong with a serial port, in our words: an error of pyserial's, or of the system, goes in."""

from __future__ import annotations

import errno

HELD = "another program has it open; close it there first"
FORBIDDEN = "you may not open it; become a member of the group that may, often dialout"
GONE = "it is gone: unplugged, closed at its other end, or read by another program, too"
NO_PORT = "it is no serial port"
USED = ("read failed", "write failed", "device reports readiness")  # what pyserial says of a port that was open
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
    errno.ECONNREFUSED: "nobody serves it; start that first",
}


def in_our_words(port: str, error: BaseException) -> str:
    """PORT: what keeps it from being used. The system's words, or pyserial's, where there are no better ones."""
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

"""A pseudo-terminal, ours to serve: what clients write comes out, what they are told goes in; it outlives each of them.

client --/dev/pts/N, or LINK--> read      write --> client
"""

from __future__ import annotations

import errno
import os
import tty
from pathlib import Path

from ..errors import OutsideError
from .backlog import AT_ONCE


class PseudoTerminal:
    """path: what clients open. link: a name for it, made as a symbolic link. OutsideError if that is taken.

    file: ours, which never blocks. kept: the clients' side, kept open, so that the last client's leaving is no end.
    """

    def __init__(self, link: Path | None) -> None:
        self.file, self.kept = os.openpty()
        tty.setraw(self.kept)
        os.set_blocking(self.file, False)
        self.path = os.ttyname(self.kept)
        self._link = link
        if link is not None:
            try:
                link.symlink_to(self.path)
            except OSError as error:
                self._link = None
                self.close()
                raise OutsideError(f"{link}: {error.strerror}; give the link another name") from None

    def close(self) -> None:
        if self._link is not None:
            self._link.unlink(missing_ok=True)
        os.close(self.file)
        os.close(self.kept)

    def read(self) -> bytes:
        """What has come, a few kilobytes of it; b"" for nothing."""
        try:
            return os.read(self.file, AT_ONCE)
        except BlockingIOError:
            return b""
        except OSError as error:
            if error.errno != errno.EIO:  # nobody has it open
                raise
            return b""

    def write(self, data: bytes) -> int:
        """How many of these bytes it took. BlockingIOError for none."""
        return os.write(self.file, data)

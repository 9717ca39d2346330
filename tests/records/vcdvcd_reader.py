"""vcdvcd's reader. Its import sets SIGPIPE to end the process silently; this module restores the handler."""

from __future__ import annotations

from signal import SIGPIPE, getsignal, signal

before = getsignal(SIGPIPE)
from vcdvcd import VCDVCD  # noqa: E402

signal(SIGPIPE, before)

__all__ = ["VCDVCD"]

"""vcdvcd's reader, without what importing it does to the process: every closed pipe would end it, without a word."""

from __future__ import annotations

from signal import SIGPIPE, getsignal, signal

before = getsignal(SIGPIPE)
from vcdvcd import VCDVCD  # noqa: E402

signal(SIGPIPE, before)

__all__ = ["VCDVCD"]

"""The origin of bytes that were read: which host frame they carry, and what would have been right."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from ...bus.i2c.transfer import Phase

BEFORE_ANY = -1  # instead of a frame's number: what firmware shows before a frame has come


class Origin(NamedTuple):
    """frame: whose values the bytes carry, the youngest of several; None where they are those of no frame.

    ended: the tick at which its last stop bit ended. wanted: of all that would have been right what agrees in the
    most bytes. judged: False if the bytes may be right or wrong, because not everything that would have been right
    was compared with them.
    """

    frame: int | None
    ended: int
    wanted: bytes
    judged: bool = True

    @property
    def known(self) -> bool:
        """They are the values of a frame that the host has sent."""
        return self.frame is not None and self.frame != BEFORE_ANY


class ReadOrigins(Protocol):
    """The origins of one transfer at a time. addresses: of the chips that show frames."""

    addresses: frozenset[int]

    def of(self, phase: Phase) -> Origin | None:
        """Return the origin of what a phase of the transfer that is just over has read; None if it is no chip's."""

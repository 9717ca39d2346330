"""Digests of a group, which is a round, a frame, or a round and a frame that overlap.

    records of the service routine of an SCI --> digest of the routine, counted from its entry
    all other records                        --> digest of the group, counted from its round

There are two digests because the accesses of the routine move with the frame, and the other records do not.
`GroupRecords.noticed` says whether the firmware can notice more of a frame than the instant of this routine.
"""

from __future__ import annotations

from zlib import crc32

from ..core.records import UNWANTED, Kind
from .free_run import RoundRecords

SCI = "SCI"  # the names of SCI modules and of their interrupts begin with this
SENDING = "SCITXBUF"
OF_XINTS = "PIEIFR12"
PADS = ("GPADAT", "GPBDAT", "GPCDAT")
ROUTINE, SERIAL, SENDS, PIE, READ, WRITE, SHOWS_LINE = range(7)  # roles of records


class GroupRecords(RoundRecords):
    """Digests of a group.

    routine: the digest of the accesses of the service routine.
    services: the number of times that the service routine of an SCI was entered since the start of the group.
    entered, left: the ticks at which the service routine was last entered and last left.
    accessed_since: the accesses of the main program, and the interrupts, since the service routine was left last.
    noticed: a phrase about the first access by which the firmware notices more of a frame than the instant of its
        service routine; "" if there was none in the run.
    """

    def __init__(self) -> None:
        super().__init__()
        self.routine = self.services = self.entered = self.left = 0
        self.noticed = ""
        self.accessed_since: set[str] = set()
        self._serving = False
        self._roles: dict[int, int] = {}
        self._texts: dict[int, str] = {}

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        """Return the tag of a topic. Records of frames on lines are left out: those of the host move with the frame."""
        if kind is Kind.FRAME:
            return UNWANTED
        super().tag_of(kind, where, what)  # this call notes the tags of CLOCK_REGISTERS
        tag = crc32(f"{kind.value} {where} {what}".encode())
        module, _, register = what.split()[-1].partition(".")
        if kind is Kind.IRQ and what.startswith(SCI):
            self._roles[tag] = ROUTINE
        elif kind is Kind.IRQ and what.startswith("XINT"):
            self._texts[tag], self._roles[tag] = what, SHOWS_LINE
        elif kind is Kind.IRQ:
            self._texts[tag], self._roles[tag] = what, WRITE
        elif kind is Kind.ACCESS and tag not in self._accesses:
            self._texts[tag] = f"{where} {what}"
            if module.startswith(SCI):
                self._roles[tag] = SENDS if register == SENDING else SERIAL
            elif (module == "GPIO" and register.startswith(PADS)) or module == "XINT" or register == OF_XINTS:
                self._roles[tag] = SHOWS_LINE
            elif module == "PIE":
                self._roles[tag] = PIE
            else:
                self._roles[tag] = READ if what.startswith("R ") else WRITE
        return tag

    def on_record(self, tag: int, tick: int, value: int) -> None:
        role = self._roles.get(tag)
        if role == ROUTINE:
            self._serving = bool(value)
            if value:
                self.services, self.entered = self.services + 1, tick
            else:
                self.left = tick
                self.accessed_since.clear()
        elif role == SENDS:
            self._notice(f"it sends: {self._texts[tag]}")
        elif self._serving and role is not None:
            self.routine = hash((self.routine, tag, 2 * (tick - self.entered) + 1, 2 * value + 1))
            if role in (READ, WRITE):
                self._notice(f"its service routine accesses {self._texts[tag]}")
        elif role == SERIAL:
            self._notice(f"it accesses {self._texts[tag]} outside of the service routine")
        elif role == SHOWS_LINE:
            self._notice(f"it depends on {self._texts[tag]}, which shows the line of the frame")
        else:
            if role in (READ, WRITE, PIE):
                self.accessed_since.add(self._texts[tag])
            if role != READ:
                super().on_record(tag, tick, value)

    def begin(self, tick: int) -> None:
        super().begin(tick)
        self.routine = self.services = 0

    def _notice(self, why: str) -> None:
        self.noticed = self.noticed or why

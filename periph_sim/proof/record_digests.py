"""Digests of what is recorded in a round or in a group. Runs of an entry of a closed table must have equal digests.

    round:  all records                              --> one digest; times are counted from the start of the round

    group:  records of the service routine of an SCI --> digest of the routine; times are counted from its entry
            all other records                        --> main digest; times are counted from the start of the round

A group has two digests because the accesses of the routine move with the frame, and the other records do not.
`GroupDigest.noticed` says whether the firmware can notice more of a frame than the instant of this routine. The
glossary in `periph_sim.proof` has the terms.
"""

# core: compiled

from __future__ import annotations

from zlib import crc32

from ..core.records import UNWANTED, Kind, Listener
from ..processor.image.data_marks import routes_lines

# Registers of the watchdog, of the PLL and of the divider of LSPCLK. Firmware must not access them after the start-up,
# because normal states leave out the watchdog, the PLL, and the former values of the divider.
CLOCK_REGISTERS = ("WDCR", "WDKEY", "WDCNTR", "SCSR", "PLLCR", "PLLSTS", "LOSPCP")
SCI = "SCI"  # the names of SCI modules and of their interrupts begin with this
SENDING = "SCITXBUF"
OF_XINTS = ("PIEIFR1", "PIEIFR12")
PADS = ("GPADAT", "GPBDAT", "GPCDAT")
ROUTINE, SERIAL, SENDS, PIE, READ, WRITE, SHOWS_LINE, ROUTES_LINE = range(8)  # kinds of records of a group


class RoundDigest(Listener):
    """Digest of what the firmware and the parties do in a round: writes, interrupts, events and frames on lines.

    accessed: the first access to one of CLOCK_REGISTERS since `begin_free`, as text; "" if there was none.
    """

    def __init__(self) -> None:
        self.accessed = ""
        self._start = self._digest = 0
        self._accesses: dict[int, str] = {}

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        tag = crc32(f"{kind.value} {where} {what}".encode())
        module, _, register = what.split()[-1].partition(".")
        if kind is Kind.ACCESS and module == "SYS" and register in CLOCK_REGISTERS:
            self._accesses[tag] = f"{where} {what}"
        elif kind is Kind.ACCESS and what.startswith("R "):  # the number of recorded reads of a wait varies
            return UNWANTED
        return tag

    def on_record(self, tag: int, tick: int, value: int) -> None:
        if tag in self._accesses:
            self.accessed = self.accessed or self._accesses[tag]
        # hash(-1) equals hash(-2), so only odd numbers are hashed
        self._digest = hash((self._digest, tag, 2 * (tick - self._start) + 1, 2 * value + 1))

    def begin(self, tick: int) -> None:
        """Begin a new digest. tick: the tick from which the times of records are counted."""
        self._start, self._digest = tick, 0

    def begin_free(self) -> None:
        """Forget the accesses so far, which are those of start-up code. Call it before the first start."""
        self.accessed = ""

    @property
    def digest(self) -> int:
        return self._digest


class GroupDigest(RoundDigest):
    """Digests of a group. `digest` is that of all records but those of the service routine of an SCI, "the routine".

    routine: the digest of the accesses of the routine.
    services: the number of times that the routine was entered since the start of the group.
    entered, left: the ticks at which the routine was last entered and last left.
    accessed_since: the texts of the accesses of the main program, and of other interrupts, since the routine was left.
    noticed: the first thing by which the firmware can notice more of a frame than the instant of the routine, such as
        "it sends: ..."; "" if there was none in the run.
    """

    def __init__(self) -> None:
        RoundDigest.__init__(self)
        self.routine = self.services = self.entered = self.left = 0
        self.noticed = ""
        self.accessed_since: set[str] = set()
        self._serving = False
        self._roles: dict[int, int] = {}
        self._texts: dict[int, str] = {}

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        """See `Listener.tag_of`. Records of frames on lines are left out, because they move with the frame."""
        if kind is Kind.FRAME:
            return UNWANTED
        RoundDigest.tag_of(self, kind, where, what)  # called because it notes the tags of CLOCK_REGISTERS
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
            elif (module == "GPIO" and register.startswith(PADS)) or module == "XINT" or register in OF_XINTS:
                self._roles[tag] = SHOWS_LINE
            elif what.startswith("W ") and routes_lines(module, register):
                self._roles[tag] = ROUTES_LINE
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
            if role in (READ, WRITE, SHOWS_LINE, ROUTES_LINE):
                self._notice(f"its service routine accesses {self._texts[tag]}")
        elif role == SERIAL:
            self._notice(f"it accesses {self._texts[tag]} outside of the service routine")
        elif role == SHOWS_LINE:
            self._notice(f"it depends on {self._texts[tag]}, which shows the line of the frame")
        elif role == ROUTES_LINE:
            self._notice(f"it accesses {self._texts[tag]}, which can change how the frame is received")
        else:
            if role in (READ, WRITE, PIE):
                self.accessed_since.add(self._texts[tag])
            if role != READ:
                RoundDigest.on_record(self, tag, tick, value)

    def begin(self, tick: int) -> None:
        RoundDigest.begin(self, tick)
        self.routine = self.services = 0

    def begin_free(self) -> None:
        RoundDigest.begin_free(self)
        self.noticed = ""

    def _notice(self, why: str) -> None:
        """Set `noticed`, if nothing was noticed before."""
        self.noticed = self.noticed or why

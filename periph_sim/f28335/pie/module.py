"""Peripheral interrupt expansion (PIE): turns the requests on 96 lines into pulses on INT1 to INT12 and vectors.

    request(group, line) --> PIEIFR --PIEIER--> PIEACK bit set? --no--> pulse on INTx, PIEACK bit is set
    vector(group)        --> the lowest line that is flagged (PIEIFR) and enabled (PIEIER) now; clears its PIEIFR bit

This model of the PIE has no clock: everything happens in the cycle of the input that causes it. `CpuInterrupts` models
the delay from a request to the CPU's IFR.

Source: SPRUFB0D sections 8.1 to 8.5.

Chosen:
- ENPIE = 0 changes only the vectors (Table 114): requests still set PIEIFR bits and cause pulses. The fetch of a vector
  from boot ROM clears no PIEIFR bit and does not change PIEVECT.
- If no flagged line of the group is enabled at the vector fetch, the CPU gets the vector of line 1. The PIEIFR bit of
  line 1 is cleared.
- TRAP and INTR with a number from 1 to 12 use the vector of line 1 of the group with this number. They clear
  no PIEIFR bit.
- A request in the cycle of the vector fetch is flagged before the fetch.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.chip import Chip
from ...core.state import State
from ..system_options import SystemOptions
from .register_map import (
    BOOT_ROM_VECTORS,
    CPU_VECTORS,
    GROUPS,
    MAP,
    PIEACK,
    PIECTRL,
    PIEIER,
    PIEIFR,
    line_vector,
    vector_address,
)

PIEVECT, ENPIE = (one.mask for one in PIECTRL.fields)


@final
class Pie(Chip):
    """The PIE. Groups are numbered 1 to 12, lines 1 to 8, as in the manual."""

    STATE = State(
        "pulses _as_reset _lines_held _pieack _piectrl _pieier _pieifr _seen _set_now _noted_blocked",
        cycles="_set_at",
        expires="_set_at",
    )
    MAP = MAP

    def __init__(self, options: SystemOptions) -> None:
        super().__init__()
        self._options = options
        self.reset(0)

    def reset(self, now: int) -> None:
        self._piectrl: int = PIECTRL.reset
        self._pieack: int = self._options.pieack_reset.unrecorded()
        # Mask of the groups whose PIEACK bit still has its reset value: neither hardware nor firmware has changed it.
        self._as_reset: int = PIEACK["PIEACK"].mask
        self._noted_blocked = 0  # mask: groups with a note that the reset value of PIEACK blocks their requests
        self._pieier: list[int] = [register.reset for register in PIEIER]
        self._pieifr: list[int] = [register.reset for register in PIEIFR]
        self._lines_held: list[int] = [0] * GROUPS
        self._set_at: list[int] = [-1] * GROUPS  # for each group, the cycle of its latest request; -1 if there was none
        self._set_now: list[int] = [0] * GROUPS  # for each group, the mask of the lines that requested in that cycle
        self._seen: list[int] = [0] * GROUPS  # for each group, the value of PIEIFR that the CPU last read
        self.pulses = 0  # bit x - 1: INTx was pulsed since the owner last set this to 0

    # Inputs from peripherals and CPU -----------------------------------------

    def request(self, now: int, group: int, line: int) -> None:
        """Latch a request that is a pulse: the peripheral does not hold the line active."""
        self._latch(now, group - 1, 1 << line - 1)
        self._send(group - 1)

    def hold(self, now: int, group: int, line: int, on: bool) -> None:
        """Set the level of a line whose requests are levels, not pulses. on: True if its peripheral holds it active.

        When the line becomes active, it requests an interrupt once. The option `pie_held_line` determines when a line
        that stays active requests again.
        """
        bit = 1 << line - 1
        rose = on and not self._lines_held[group - 1] & bit
        self._lines_held[group - 1] = self._lines_held[group - 1] & ~bit | (bit if on else 0)
        if rose:
            self._latch(now, group - 1, bit)
            self._send(group - 1)

    def has_request(self, group: int) -> bool:
        """Return True if a line of the group is flagged and enabled."""
        return self._pieifr[group - 1] & self._pieier[group - 1] != 0

    def vector(self, now: int, group: int) -> tuple[int, int]:
        """Fetch the vector for the group's CPU interrupt. Return (line, address of the vector).

        The line is 0 if the vector comes from boot ROM. Otherwise the call clears the PIEIFR bit of the line. If the
        line is held, the option `pie_held_line` may set the bit again at once.
        """
        if not self._piectrl & ENPIE:
            return 0, BOOT_ROM_VECTORS + 2 * group
        g = group - 1
        ready = self._pieifr[g] & self._pieier[g]
        bit = ready & -ready or 1
        line = bit.bit_length()
        self._pieifr[g] &= ~bit
        self._fetched(line_vector(group, line))
        if self._lines_held[g] & bit and self._level_sensitive(g):
            self._latch(now, g, bit)
        return line, line_vector(group, line)

    def cpu_vector(self, number: int) -> int:
        """Fetch vector `number` for INT13 and above, or for TRAP or INTR. Return the address of the vector.

        With ENPIE = 1, PIEVECT is updated, and a number from 1 to 12 means line 1 of the group with this number. Vector
        0, for reset, is always in boot ROM, and does not change PIEVECT.
        """
        if not self._piectrl & ENPIE or number == CPU_VECTORS["RESET"]:
            return BOOT_ROM_VECTORS + 2 * number
        address = vector_address(number)
        if number <= GROUPS:
            address = line_vector(number, 1)
            self.note(
                "duty",
                f"TRAP or INTR took vector {number} with the PIE enabled; it is not meant for vectors 1 to 12",
                "SPRU430F TRAP, INTR",
            )
        self._fetched(address)
        return address

    # The chip's interface ----------------------------------------------------

    def read(self, now: int, offset: int) -> int:
        if offset & 1 and 1 <= offset // 2 <= GROUPS:
            self._seen[offset // 2 - 1] = self._pieifr[offset // 2 - 1]
        return self.see(now, offset)

    def see(self, now: int, offset: int) -> int:
        if offset == PIEACK.offset and self._as_reset:
            self._options.pieack_reset.assume(self.touched)
        return self.peek(now, offset)

    def peek(self, now: int, offset: int) -> int:
        """Return the register's value; 0 if there is no register."""
        if offset == PIECTRL.offset:
            return self._piectrl
        if offset == PIEACK.offset:
            return self._pieack
        if not 1 <= offset // 2 <= GROUPS:
            return 0
        return self._pieifr[offset // 2 - 1] if offset & 1 else self._pieier[offset // 2 - 1]

    def write(self, now: int, offset: int, value: int) -> None:
        if offset == PIECTRL.offset:
            self._piectrl, _ = PIECTRL.write(self._piectrl, value)
        elif offset == PIEACK.offset:
            self._acknowledge(now, value)
        elif 1 <= offset // 2 <= GROUPS:
            g = offset // 2 - 1
            if offset & 1:
                self._write_pieifr(now, g, value)
            else:
                self._pieier[g], _ = PIEIER[g].write(self._pieier[g], value)
            self._send(g)

    # Flags and pulses ---------------------------------------------------------

    def _latch(self, now: int, g: int, bits: int) -> None:
        self._pieifr[g] |= bits
        if self._set_at[g] != now:
            self._set_at[g] = now
            self._set_now[g] = 0
        self._set_now[g] |= bits

    def _send(self, g: int) -> None:
        """Pulse INTx, x = g + 1, if a flagged line of the group is enabled and PIEACK does not block the group."""
        if not self.has_request(g + 1):
            return
        if self._as_reset >> g & 1:
            self._options.pieack_reset.assume(self.touched)
            if self._pieack & ~self._noted_blocked & 1 << g:
                self._noted_blocked |= 1 << g
                self.note(
                    "unknown",
                    f"request of group {g + 1} is blocked by the reset value of PIEACK (pieack_reset = 0xfff); "
                    "no interrupt of the group is served before firmware writes PIEACK",
                    "SPRUFB0D Figure 85",
                )
        if not self._pieack >> g & 1:
            self._pieack |= 1 << g
            self._as_reset &= ~(1 << g)
            self.pulses |= 1 << g

    def _acknowledge(self, now: int, value: int) -> None:
        unblocked = self._pieack & value
        self._as_reset &= ~value
        self._pieack, _ = PIEACK.write(self._pieack, value)
        for g in range(GROUPS):
            if unblocked >> g & 1:
                if self._lines_held[g] and not self._level_sensitive(g):
                    self._latch(now, g, self._lines_held[g])
                self._send(g)

    def _level_sensitive(self, g: int) -> bool:
        """Return True if a line of group g + 1 is held active, and sets its PIEIFR bit again as soon as it is cleared.

        The option `pie_held_line` determines when held lines set their bits again.
        """
        if not self._lines_held[g]:
            return False
        return self._options.pie_held_line.assume(self.touched) == "at_vector_fetch"

    def _write_pieifr(self, now: int, g: int, value: int) -> None:
        before = self._pieifr[g]
        set_now = self._set_now[g] if self._set_at[g] == now else 0
        self._pieifr[g], _ = PIEIFR[g].write(before, value, set_now)
        if self._level_sensitive(g):
            self._pieifr[g] |= self._lines_held[g]
        cleared = before & ~self._pieifr[g]
        name = PIEIFR[g].name
        lost = cleared & ~self._seen[g]
        if lost:
            self.note(
                "lost",
                f"a write of {value:#06x} to {name} erased the requests {lost:#04x}, which firmware had not read yet",
                "SPRUFB0D section 8.3.1 rule 1",
            )
        if cleared & self._seen[g]:
            self.note(
                "duty",
                f"a write of {value:#06x} to {name} cleared flags; only the service of an interrupt should do so",
                "SPRUFB0D section 8.3.1 rule 1",
            )

    def _fetched(self, address: int) -> None:
        self._piectrl = self._piectrl & ~PIEVECT | address & PIEVECT

"""System control: clock ratio, prescalers, module gates, and the watchdog's resets and interrupts.

    PLLCR, PLLSTS  -->  sysclk_hz
    LOSPCP, HISPCP -->  lspclk_divider, lspclk_phase, hspclk_divider
    PCLKCR0/3      -->  gates, enabled()                        (2 cycles after the write)
    SCSR, WDCR, .. -->  reset_requested, WAKEINT in `requests`

Times are SYSCLKOUT cycles as for every chip, but this chip sets the length of a cycle. After every input the owner
compares `sysclk_hz` with its old value. If it has changed, cycles from that input's `now` on have the new length. Such
a change does not disturb the counts of OSCCLK periods (PLL lock, watchdog).

When `reset_requested` is True, the owner resets every chip, including this one, and starts the CPU WDRST_CYCLES later,
because the watchdog holds XRS low for that time.

Source: SPRUFB0D section 5; lock time SPRS439M Table 6-9; boot ROM SPRS439M Table 3-17.

Chosen:
- Every write of PLLCR makes the PLL lock again, even if the value is the same or 0 (Table 22 names the write, not a
  change of the value).
- The manual requires DIVSEL = 0 while the PLL locks. With pll_lock_clock = osc_div_4, another DIVSEL divides OSCCLK as
  in bypass (DIVIDE).
- A reserved PLLCR value acts as bypass. DIVSEL = 3 with the PLL on divides by 1.
- New prescaler values take effect at once.
- If there is no register at an address, a read returns 0 and a write has no effect.

Missing-clock detection, limp mode, STANDBY and HALT are not modelled. Their bits are stored. A note is added when
firmware sets OSCOFF or selects STANDBY or HALT.
"""

from __future__ import annotations

from fractions import Fraction

from ...core.chip import ANY_CHANGED, NEVER, Chip
from ...core.state import State
from ..system_options import SystemOptions
from .oscclk import PARTS, OscClock
from .register_map import (
    HISPCP,
    LOSPCP,
    LPMCR0,
    MAP,
    PCLKCR0,
    PCLKCR1,
    PCLKCR3,
    PLLCR,
    PLLSTS,
    SCSR,
    WDCNTR,
    WDCR,
    WDKEY,
)
from .watchdog import WDFLAG, WDINT_OSCCLKS, Watchdog

PLL_LOCK_OSCCLKS = 131072  # OSCCLK periods until the PLL is locked, SPRS439M Table 6-9
VCO_MAX_HZ = 300_000_000  # section 5.2.1
GATE_DELAY = 2  # SYSCLKOUT cycles from a PCLKCR write to its effect, section 5.1.1
WDINTS_DELAY = 2  # SYSCLKOUT cycles from a change of WDINT to that of SCSR.WDINTS, Table 27
WDRST_CYCLES = WDINT_OSCCLKS // 4  # duration of a watchdog reset in SYSCLKOUT cycles; SYSCLKOUT is OSCCLK/4 in a reset
WDFLAG_DELAY = WDRST_CYCLES + 8192  # SYSCLKOUT cycles from the start of a watchdog reset to WDFLAG = 1 (below Table 30)

DIVIDE = (4, 4, 2, 1)  # for each value of DIVSEL, the divider from the PLL's output to SYSCLKOUT
DIVSEL = PLLSTS["DIVSEL"]
PLLLOCKS, PLLOFF, OSCOFF, MCLKOFF = (PLLSTS[name].mask for name in ("PLLLOCKS", "PLLOFF", "OSCOFF", "MCLKOFF"))
WDINTS = SCSR["WDINTS"].mask
LPM = LPMCR0["LPM"]

GATES = {one.name: one.mask for one in PCLKCR0.fields} | {one.name: one.mask << 16 for one in PCLKCR3.fields}
STORED = (HISPCP, LOSPCP, PCLKCR0, PCLKCR1, PCLKCR3, LPMCR0)  # registers whose values only software changes


def prescale(code: int) -> int:
    """Return the divider of a LOSPCP or HISPCP code: 1, 2, 4, 6, 8, 10, 12, 14."""
    return 2 * code or 1


class SystemControl(Chip):
    """System control.

    oscclk_hz: frequency of OSCCLK.
    sysclk_hz: exact frequency of SYSCLKOUT.
    """

    STATE = State(
        "_clock _watchdog sysclk_hz reset_requested gates "
        "hspclk_divider lspclk_divider _pllsts _pllcr _stored "
        "_wdint _wdints _locked_at",
        cycles="lspclk_phase _wdflag_at _gates_to_come _wdints_to_come",
        grids={"lspclk_phase": "lspclk_divider"},
    )
    MAP = MAP

    def __init__(self, oscclk_hz: int, options: SystemOptions) -> None:
        super().__init__()
        self.oscclk_hz = oscclk_hz
        self.reset_requested = False  # True if the watchdog requests a reset; `reset` clears this
        self._options = options
        self._clock = OscClock()
        self._watchdog = Watchdog(options, self.touched)
        self.sysclk_hz = Fraction(oscclk_hz)  # `reset` sets it to OSCCLK/4
        self._gates_to_come: list[tuple[int, int]] = []  # later values of `gates`: (cycle, value)
        self._wdints_to_come: list[tuple[int, int]] = []  # later values of WDINTS: (cycle, value)
        self.reset(0)

    def reset(self, now: int) -> None:
        """Reset by XRS. If the watchdog requested it (`reset_requested`), WDFLAG is set WDFLAG_DELAY cycles later."""
        by_watchdog = self.reset_requested
        self._pllcr = PLLCR.reset
        self._pllsts = PLLSTS.reset
        # OSCCLK position (`oscclk`) at which the PLL will be locked; NEVER while the PLL is not locking.
        self._locked_at = NEVER
        self._stored = {register.offset: register.reset for register in STORED}
        self.hspclk_divider = prescale(HISPCP.reset)
        self.lspclk_divider = prescale(LOSPCP.reset)
        self.lspclk_phase = now  # LSPCLK begins a period at this cycle and every `lspclk_divider` cycles from it
        self.gates = self._gates()  # clock gates in effect: PCLKCR3 in bits 31:16, PCLKCR0 in bits 15:0
        self._gates_to_come.clear()
        self._watchdog.reset(self._clock.at(now))
        self.requests = 0
        self.reset_requested = False
        self._wdint = 1  # level of WDINT at the last update
        self._wdints = 1
        self._wdints_to_come.clear()
        self._wdflag_at = now + WDFLAG_DELAY if by_watchdog else NEVER
        self._tune(now)
        self._schedule()

    def normal_state(self, cycle: int, tick: int) -> dict[str, object]:
        """For comparisons of states, leave out OSCCLK and the watchdog while no event is due on OSCCLK.

        See `proof.normal_state`.

        A scene whose firmware accesses the watchdog or the PLL must not be compared in this way.
        """
        is_idle = self._locked_at == NEVER and self._watchdog.next_due == NEVER
        return dict.fromkeys(["_clock", "_watchdog"]) if is_idle else {}

    # Queries ----------------------------------------------------------------

    def enabled(self, gate: str) -> bool:
        """Return True if the clock that a field of PCLKCR0 or PCLKCR3 switches is on."""
        return bool(self.gates & GATES[gate])

    def watchdog_rounds(self, since: int, now: int) -> int:
        """Return how often WDCNTR can count through all its values between two cycles.

        SYSCLKOUT must not change between the two cycles.
        """
        return self._watchdog.rounds(self._clock.at(now) - self._clock.at(since))

    # Inputs -----------------------------------------------------------------

    def wake(self, now: int) -> int:
        self._sync(now)
        return ANY_CHANGED

    def peek(self, now: int, offset: int) -> int:
        """Return the register's value; 0 if there is no register. Reads have no side effects."""
        self._sync(now)
        register = MAP.at(offset)
        return 0 if register is None else register.read(self._value(now, offset))[0]

    def write(self, now: int, offset: int, value: int) -> None:
        """Write a register. EALLOW is not checked here, because the bus blocks writes without EALLOW."""
        self._sync(now)
        if offset == PLLSTS.offset:
            self._write_pllsts(now, value)
        elif offset == PLLCR.offset:
            self._write_pllcr(now, value)
        elif offset in self._stored:
            self._write_stored(now, offset, value)
        elif offset == WDKEY.offset:
            self._watchdog.write_wdkey(self._clock.at(now), value)
        elif offset == WDCR.offset:
            self._watchdog.write_wdcr(self._clock.at(now), value)
        elif offset == SCSR.offset:
            self._watchdog.write_scsr(self._clock.at(now), value)
        self._update_from_watchdog(now)
        self._schedule()

    def boot(self, now: int) -> None:
        """Set DIVSEL = 2, as the boot ROM does before user code."""
        self._sync(now)
        self._pllsts = DIVSEL.put(self._pllsts, 2)
        self._tune(now)
        self._schedule()

    # Registers --------------------------------------------------------------

    def _value(self, now: int, offset: int) -> int:
        """Return the value of the register at an offset of the map. WDKEY reads as WDCR."""
        if offset == WDCR.offset or offset == WDKEY.offset:
            return self._watchdog.wdcr
        if offset == WDCNTR.offset:
            return self._watchdog.count(self._clock.at(now))
        if offset == SCSR.offset:
            return self._watchdog.scsr & ~WDINTS | (WDINTS if self._wdints else 0)
        if offset == PLLSTS.offset:
            return self._pllsts
        return self._pllcr if offset == PLLCR.offset else self._stored[offset]

    def _write_pllsts(self, now: int, value: int) -> None:
        before = self._pllsts
        self._pllsts, _ = PLLSTS.write(before, value)
        divsel = DIVSEL.extract(self._pllsts)
        if divsel != DIVSEL.extract(before) and not before & PLLLOCKS:
            self.note(
                "duty",
                f"PLLSTS.DIVSEL was changed to {divsel} while the PLL locks; it may change once PLLLOCKS is 1",
                "SPRUFB0D section 5.2.4",
            )
        self._check_divsel()
        if self._pllsts & PLLOFF and self._pllcr:
            self.note(
                "duty",
                f"PLLSTS.PLLOFF was set with PLLCR = {self._pllcr}; it may be set in bypass only",
                "SPRUFB0D Table 22",
            )
        if self._pllsts & ~before & OSCOFF:
            self.note("unknown", "PLLSTS.OSCOFF = 1: missing-clock detection is not modelled", "SPRUFB0D Table 22")
        self._tune(now)

    def _write_pllcr(self, now: int, value: int) -> None:
        divsel = DIVSEL.extract(self._pllsts)
        self._pllcr, _ = PLLCR.write(self._pllcr, value)
        if divsel:
            self.note(
                "duty", f"PLLCR was written with PLLSTS.DIVSEL = {divsel}; it must be 0 first", "SPRUFB0D section 5.2.4"
            )
        if not self._pllsts & MCLKOFF:
            self.note("duty", "PLLCR was written with PLLSTS.MCLKOFF = 0; set it first", "SPRUFB0D Figure 22")
        if self._watchdog.enabled:
            self.note("duty", "PLLCR was written with the watchdog on; it should be off", "SPRS439M section 3.6.1.2")
        if self._pllcr > 10:
            self.note("duty", f"PLLCR = {self._pllcr} is reserved; expected 0 to 10", "SPRUFB0D Table 21")
        elif self._pllcr and self._pllsts & PLLOFF:
            self.note("duty", f"PLLCR = {self._pllcr} was written with PLLSTS.PLLOFF = 1", "SPRUFB0D Table 22")
        vco = self._ratio() * self.oscclk_hz
        if vco > VCO_MAX_HZ:
            self.note(
                "duty", f"the PLL would run at {vco} Hz; at most {VCO_MAX_HZ} Hz are allowed", "SPRUFB0D section 5.2.1"
            )
        self._check_divsel()
        self._pllsts &= ~PLLLOCKS
        self._locked_at = self._clock.at(now) + PLL_LOCK_OSCCLKS * PARTS
        self._tune(now)

    def _write_stored(self, now: int, offset: int, value: int) -> None:
        register = MAP.at(offset)
        assert register is not None
        stored, _ = register.write(self._stored[offset], value)
        self._stored[offset] = stored
        if register is HISPCP:
            self.hspclk_divider = prescale(stored)
        elif register is LOSPCP:
            self.lspclk_divider = prescale(stored)
            if self.lspclk_divider > 1 and self._options.lspclk_phase.assume(self.touched) == "restart_on_write":
                self.lspclk_phase = now
        elif register is LPMCR0 and LPM.extract(stored):
            self.note(
                "unknown", "LPMCR0 selects STANDBY or HALT: the model's IDLE stops the CPU only", "SPRUFB0D section 5.3"
            )
        elif register in (PCLKCR0, PCLKCR3):
            self._gates_to_come.append((now + GATE_DELAY, self._gates()))

    # Timed changes ----------------------------------------------------------

    def _sync(self, now: int) -> None:
        while self.next_wake <= now:
            cycle = self.next_wake
            self._watchdog.advance(self._clock.at(cycle))
            self._update_from_watchdog(cycle)
            if self._clock.at(cycle) >= self._locked_at:
                self._locked_at = NEVER
                self._pllsts |= PLLLOCKS
                self._tune(cycle)
            while self._gates_to_come and self._gates_to_come[0][0] <= cycle:
                self.gates = self._gates_to_come.pop(0)[1]
            while self._wdints_to_come and self._wdints_to_come[0][0] <= cycle:
                self._wdints = self._wdints_to_come.pop(0)[1]
            if cycle >= self._wdflag_at:
                self._wdflag_at = NEVER
                self._watchdog.wdcr |= WDFLAG
            self._schedule()

    def _schedule(self) -> None:
        wake = self._wdflag_at
        due = min(self._locked_at, self._watchdog.next_due)
        if due < NEVER:
            wake = min(wake, self._clock.cycle_at(due))
        if self._gates_to_come:
            wake = min(wake, self._gates_to_come[0][0])
        if self._wdints_to_come:
            wake = min(wake, self._wdints_to_come[0][0])
        self.next_wake = wake

    def _update_from_watchdog(self, cycle: int) -> None:
        dog = self._watchdog
        if dog.wdint != self._wdint:
            self._wdint = dog.wdint
            self._wdints_to_come.append((cycle + WDINTS_DELAY, dog.wdint))
        if dog.interrupt:
            dog.interrupt = False
            self.requests |= 1
        self.reset_requested = dog.reset_requested

    def _ratio(self) -> int:
        """Return the PLL's multiplier; 1 in bypass, with PLLOFF = 1, and for a reserved value of PLLCR."""
        return self._pllcr if 1 <= self._pllcr <= 10 and not self._pllsts & PLLOFF else 1

    def _tune(self, now: int) -> None:
        """Apply the clock that results from PLLCR, DIVSEL and the lock state."""
        divide = DIVIDE[DIVSEL.extract(self._pllsts)]
        ratio = self._ratio()
        if not self._pllsts & PLLLOCKS:
            ratio = 1
            if self._options.pll_lock_clock.assume(self.touched) == "osc_div_2":
                divide = 2
        self.sysclk_hz = Fraction(self.oscclk_hz * ratio, divide)
        self._clock.retune(now, ratio, divide)

    def _gates(self) -> int:
        return self._stored[PCLKCR3.offset] << 16 | self._stored[PCLKCR0.offset]

    def _check_divsel(self) -> None:
        if DIVSEL.extract(self._pllsts) == 3 and self._pllcr:
            self.note(
                "duty",
                f"PLLSTS.DIVSEL = 3 with PLLCR = {self._pllcr}; it is allowed with PLLCR = 0 only",
                "SPRUFB0D Table 22",
            )

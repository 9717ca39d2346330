"""External interrupts XINT1 to XINT7, which edges at pins request.

For XINT1 and XINT2 a counter measures the time since the last edge.

    level --> edge of the chosen polarity, if enabled --> requests
                              |
                              +--> XINTnCTR = 0, then +1 each SYSCLKOUT (XINT1, XINT2)

The levels come from `Gpio`, after the input qualifier of the pin that GPIOXINTnSEL selects. `Gpio` reports only edges
of lines that are enabled in XINTnCR. So the owner makes these calls around each write to this module:

    xint.settle(now, gpio.xint_levels(now))
    xint.write(now, offset, value)
    gpio.watch_xints(now, xint.enabled)

The counters change in every cycle, so they are computed when they are read, and `next_wake` does not include them.

Source: SPRUFB0D section 8.6, Figures 91 to 95, Tables 121 to 126.

Chosen:
- A counter runs from the moment its line is enabled, even before the first edge.
- XNMI is not modelled: XNMICR is stored, and enabling XNMI adds a note. XNMICTR reads 0. The owner uses SELECT of
  XNMICR to decide whether timer 1 requests INT13.
"""

from __future__ import annotations

from ...core.chip import ANY_CHANGED, NO_CHANGE, Chip
from ...core.state import State
from .register_map import XINT

LINES = 7
XNMICR = XINT["XNMICR"].offset
ENABLE = XINT["XINT1CR"]["ENABLE"]
POLARITY = XINT["XINT1CR"]["POLARITY"]
COUNTERS = {XINT["XINT1CTR"].offset: 0, XINT["XINT2CTR"].offset: 1}  # maps a counter's offset to line 0 or 1
RISING, BOTH = 1, 3  # values of POLARITY; 0 and 2 mean falling


class Xint(Chip):
    STATE = State("enabled _control _count _level", cycles="_since")
    MAP = XINT
    INPUTS = tuple(f"XINT{n}" for n in range(1, LINES + 1))

    def __init__(self) -> None:
        super().__init__()
        self._level = 0
        self._since = [0, 0]  # for XINT1CTR and XINT2CTR: cycle at which the running counter was, or would have been, 0
        self.reset(0)

    def reset(self, now: int) -> None:
        """Reset by XRS: all lines are disabled, and the counters are 0. The lines keep their levels."""
        self.requests = 0
        self.enabled = 0  # mask: lines that are enabled, so that their edges request an interrupt
        self._control = [0] * (LINES + 1)  # values of XINT1CR to XINT7CR and XNMICR
        self._count = [0, 0]  # values of XINT1CTR and XINT2CTR while they are stopped

    def settle(self, now: int, levels: int) -> None:
        """Set the levels of the lines that are not enabled. A change of such a level is not an edge.

        levels: the levels of all lines; bit 0 is XINT1.
        """
        self._level = self._level & self.enabled | levels & ~self.enabled

    def pins(self, now: int, levels: int) -> int:
        """Set the levels on INPUTS. An edge of the chosen polarity on an enabled line requests its interrupt."""
        moved, self._level = (levels ^ self._level) & self.enabled, levels
        if not moved:
            return NO_CHANGE
        for line in range(LINES):
            if not moved >> line & 1:
                continue
            polarity = POLARITY.extract(self._control[line])
            if polarity == BOTH or (polarity == RISING) == bool(levels >> line & 1):
                self.requests |= 1 << line
                if line < len(self._since):
                    self._since[line] = now
        return ANY_CHANGED

    def peek(self, now: int, offset: int) -> int:
        if offset <= XNMICR:
            return self._control[offset]
        line = COUNTERS.get(offset)
        return 0 if line is None else self._counted(now, line)

    def write(self, now: int, offset: int, value: int) -> None:
        if offset > XNMICR:
            return
        register = XINT.at(offset)
        assert register is not None, "the control registers are contiguous"
        self._control[offset], _ = register.write(self._control[offset], value & 0xFFFF)
        enable = self._control[offset] & ENABLE.mask
        if offset == XNMICR:
            if enable:
                self.note("unknown", "XNMI is enabled but not modelled: no NMI will occur", "SPRUFB0D Table 122")
            return
        if offset < len(self._since):  # a counter that is stopped keeps its count, and continues from there
            self._count[offset] = self._counted(now, offset)
            self._since[offset] = now - self._count[offset]
        self.enabled = self.enabled & ~(1 << offset) | enable << offset

    def _counted(self, now: int, line: int) -> int:
        return now - self._since[line] & 0xFFFF if self.enabled >> line & 1 else self._count[line]

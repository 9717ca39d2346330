"""The conditions of the I2C master: START, repeated START and STOP, and what a START latches for its transfer.

    SDA falls while SCL is high: START      SDA rises while SCL is high: STOP

`master` decides when they are due. Source: SPRUG03B sections 2.3 to 2.8, 5.7, Tables 5, 6.

Chosen:
- START hold, repeated START setup and STOP setup last one high time of SCL.
"""

# core: compiled

from __future__ import annotations

from ...core.state import State
from .clock import FALL, RESTART, STARTED, STOP, I2cClock
from .limits import I2cLimits
from .register_map import MDR_DLB, MDR_FDF, MDR_TRX, MDR_XA, SDA, STR_ARDY
from .registers import I2cRegisters


class I2cConditions(I2cClock):
    """Adds conditions to the clock generator. counter: bytes left of the transfer."""

    STATE = State("counter _addresses _starting _stopping _own_restart _restart_next")

    def __init__(self, state: I2cRegisters, limits: I2cLimits) -> None:
        super().__init__(state)
        self.limits = limits

    def reset_conditions(self) -> None:
        """Forget the transfer."""
        self.counter = 0
        self._addresses: list[int] = []
        self._starting = False  # our START, or repeated START, has not been detected yet
        self._stopping = False  # our STOP has not been detected yet
        self._own_restart = False
        self._restart_next: list[int] = []  # addresses after an automatic repeated START

    def _latch_command(self) -> None:
        """Latch the registers that apply to the whole transfer, at its START."""
        state = self.state
        if state.options.cnt_copy_point.assume(state.touched) == "start":
            self.load_counter()
        self._own_restart = False
        self._restart_next = []
        self._addresses = [] if state.mdr & MDR_FDF else self._address_bytes()
        self.limits.scl(self.low(), self.high())

    def load_counter(self) -> None:
        self.counter = self.state.cnt or 65536

    def _address_bytes(self) -> list[int]:
        state = self.state
        mdr = state.mdr
        if not mdr & MDR_DLB:
            self.limits.sent_address()
        address = state.oar if mdr & MDR_DLB else state.sar
        read = 0 if mdr & MDR_TRX else 1
        if not mdr & MDR_XA:
            return [(address & 0x7F) << 1 | read]
        header = 0xF0 | address >> 7 & 6
        if not read:
            return [header, address & 0xFF]
        if state.options.ten_bit_read.assume(state.touched) == "full_address_first" and not self.active:
            self._restart_next = [header | 1]
            return [header, address & 0xFF]
        return [header | 1]

    def _begin_start(self, now: int) -> None:
        state = self.state
        self.pulls |= SDA
        self._starting = True
        self._high_phase = False
        state.wanted = state.trx()
        state.clear(now, STR_ARDY)
        self._at(now + self.high(), STARTED)

    def _restart(self, now: int, own: bool) -> None:
        """Begin a repeated START. own: it belongs to the command in progress."""
        self._own_restart = own
        if not own:
            self._latch_command()
        self._begin_condition(now, 1, RESTART)

    def _restart_high(self, now: int) -> None:
        self._after_high = FALL
        self._begin_start(now)

    def _stop(self, now: int) -> None:
        self.state.clear(now, STR_ARDY)
        self._begin_condition(now, 0, STOP)

    def _stop_high(self) -> None:
        self._stopping = True
        self._after_high = FALL
        self._high_phase = False
        self.pulls &= ~SDA

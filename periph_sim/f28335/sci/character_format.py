"""Format of the frames of both directions, derived from SCICCR, with the positions of their bits.

    start  data LSB first  [address]  [parity]  stop [stop]

Source: TI SPRUFZ5A sections 1.2.3 and 1.2.6, table 2-3; SPRZ272N figure 3-1 (erratum: in address-bit mode the search
for the next start bit does not begin in the stop bit, but already in the address bit).
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.state import State
from .options import SciOptions
from .register_map import ADDRIDLE_MODE, PARITY, PARITYENA, SCICHAR, STOPBITS

# For each value of `rxrdy_point`: SCICLK periods from the start of the stop bit to the move of the word to SCIRXBUF.
DUE = {"seven_eighths": 7, "drawing": 6, "stop_end": 8}
BREAK_TICKS = {"10": 80, "9.625": 77}


@final
class SciFormat:
    """Format of a frame. The start bit is bit 0. Ticks are SCICLK periods from the first low sample of the start bit.

    stop_bit: the index of the first stop bit.
    bits: how many bits the frame has, with start and stop bits.
    stop_at: the tick at which the first stop bit begins.
    vote_at, voted_at: the ticks of the first and last sample that vote on the value of the stop bit.
    due: the tick at which the word moves to SCIRXBUF.
    hunt: the tick from which the search for the next start bit begins.
    end: the tick at which the last stop bit ends.
    break_at: the tick at which a break is detected.

    Options determine `vote_at`, `voted_at`, `due`, `hunt` and `break_at`. The receiver records the use of such an
    option when a received frame depends on it.
    """

    STATE = State(
        "data_bits data_mask stops stop_bit bits stop_at vote_at voted_at due end hunt break_at address parity even",
        made=True,
    )

    def __init__(self, sciccr: int, options: SciOptions) -> None:
        self.data_bits: int = (sciccr & SCICHAR) + 1
        self.data_mask: int = (1 << self.data_bits) - 1
        self.address = bool(sciccr & ADDRIDLE_MODE)
        self.parity = bool(sciccr & PARITYENA)
        self.even = bool(sciccr & PARITY)
        self.stops: int = 2 if sciccr & STOPBITS else 1
        self.stop_bit: int = 1 + self.data_bits + self.address + self.parity
        self.bits: int = self.stop_bit + self.stops
        stop = 8 * self.stop_bit
        self.stop_at: int = stop
        self.vote_at: int = stop + (3 if options.stop_vote_samples.unrecorded() == "4_5_6" else 2)
        self.voted_at: int = self.vote_at + 2
        self.due: int = stop + DUE[options.rxrdy_point.unrecorded()]
        self.end: int = 8 * self.bits
        self.hunt: int = stop + options.start_hunt_point.unrecorded() - 1
        if self.address:  # erratum: hunt from sub-sample 6 of the address bit or, if an option says so, the parity bit
            bit_later = self.parity and options.addrbit_hunt_with_parity.unrecorded() == "parity_bit"
            self.hunt = 8 * (1 + self.data_bits + bit_later) + 5
        counted_from = self.voted_at if options.break_count_from.unrecorded() == "last_stop_sample" else stop + 7
        self.break_at: int = counted_from + BREAK_TICKS[options.break_bits.unrecorded()]

    def parity_bit(self, word: int, address: int) -> int:
        """Return the parity bit.

        With it, the number of ones in word, address bit and parity bit is even if `even` is True, else odd.
        """
        ones = word.bit_count() + (address if self.address else 0)
        return ones & 1 if self.even else ones & 1 ^ 1

    def levels(self, word: int, address: int, whole_byte: bool) -> int:
        """Return the frame's levels as a number, with the start bit in bit 0. Stop bits are ones.

        whole_byte: True if the parity is that of all eight bits of `word`, even those that are not sent.
        """
        data = word & self.data_mask
        at = 1 + self.data_bits
        levels = data << 1
        if self.address:
            levels |= address << at
            at += 1
        if self.parity:
            levels |= self.parity_bit(word if whole_byte else data, address) << at
            at += 1
        return levels | ((1 << self.stops) - 1) << at

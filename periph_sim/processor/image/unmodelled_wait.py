"""A wait for unmodelled registers, which continues across interrupts.

asleep in the loop --interrupt--> service routine --IRET--> first passes of the loop --> asleep again
                   |<------------------------- the wait continues ----------------->|
"""

from __future__ import annotations

from typing import NamedTuple

from .awaited import LoopRange
from .cpu import ImageCpu

LCR_WORDS = 2


class UnmodelledWait(NamedTuple):
    """since: the cycle at which it began. addresses: the unmodelled words that it reads.

    sp: the stack pointer in the loop. routines: number of service routines active there.
    """

    since: int
    loop: LoopRange
    sp: int
    routines: int
    addresses: list[int]

    def goes_on(self, cpu: ImageCpu) -> bool:
        """Return True if the program is in the loop, in a function that it calls, or in a routine that interrupts it.

        Call it at each entry of a service routine, too, and drop a wait that is over there.
        """
        routines = cpu.polls.routines
        if routines != self.routines:
            return routines > self.routines
        first, branch = self.loop
        if first <= cpu.pc <= branch:
            return cpu.sp == self.sp
        return cpu.sp > self.sp and first < cpu.rpc <= branch + LCR_WORDS

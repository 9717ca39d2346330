"""Words that wait in the SCI's receive FIFO at most: a service routine's reads go in, high-water and overruns come out.

    RXFFST = RXFFIL --request, latency--> routine --> read 1 --> read 2 --> ... --> read n
        '-- characters that come meanwhile, at least a character apart --'

    high-water = RXFFIL + max over k (characters up to read k - reads before it)

It holds whatever the host sends, since no receiver takes characters faster than it samples them.
Source: SPRUFZ5A sections 1.2.5 and 1.2.10.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import ceil, floor
from typing import TYPE_CHECKING

from msgspec import Struct

from ...f28335.sci.register_map import SCI_MAP
from .terms import Bound, Term, reasons, total

if TYPE_CHECKING:
    from ...processor.dsp import Dsp

SCI, VECTOR = "SCI-A", "SCIRXINTA"
READ = f"R {SCI}.SCIRXBUF"


class Receiver(Struct, frozen=True):
    """level: words at which the FIFO asks for service. reads: of a routine, in ticks from its entry on.

    character: ticks between two that are received, at least: its stop bit may be cut short. delay: from the last word
    to the request, at most. counts_unread: any word that finds another unread counts as an overrun. left: words that
    stay in the FIFO when all frames are over.
    """

    level: int
    reads: tuple[int, ...]
    character: int
    delay: int
    counts_unread: bool
    left: int = 0

    def more(self, latency: int, routine: int) -> int:
        """Words beyond the level, at most, until the routine has read them."""
        coming = (self._coming(latency + at) - before for before, at in enumerate((*self.reads, routine)))
        return max(0, *coming)

    def keeps_up(self, latency: int, routine: int) -> bool:
        """A routine takes all words that asked for it, is over before as many have come again, and is entered again."""
        return len(self.reads) >= self.level > max(self.left, self._coming(latency + routine))

    def _coming(self, ticks: int) -> int:
        return (self.delay + ticks) // self.character


def receiver_of(dsp: Dsp, now: int, reads: Sequence[Sequence[int]], ticks_per_second: int) -> Receiver | None:
    """The receiver of a unit whose routines read at these instants; None if no FIFO interrupt serves it."""
    from ...f28335.sci.options import SciOptions  # what this unit has, or nobody would ask
    from ...f28335.sci.receiver import RXFFIENA, RXFFIL
    from ...scene.uart_lines import line_of

    socket, cycle = dsp.socket(SCI), dsp.clock.cycle_at(now)
    fifo_on = SCI_MAP["SCIFFTX"]["SCIFFENA"].of(socket.peek(cycle, SCI_MAP["SCIFFTX"].offset))
    settings = socket.peek(cycle, SCI_MAP["SCIFFRX"].offset)
    level = settings & RXFFIL
    if not fifo_on or not settings & RXFFIENA or not level:
        return None
    line, options = line_of(dsp), dsp.plan.answers(SciOptions)
    bit = ticks_per_second / Fraction(line.baud)
    count = min(map(len, reads))
    latest = tuple(max(times[k] for times in reads) for k in range(count))
    character = floor(bit * (1 + line.bits + (line.parity != "none")))
    delay = ceil(bit + options.rx_int_extra.unrecorded() * Fraction(ticks_per_second) / dsp.clock.hz)
    left = SCI_MAP["SCIFFRX"]["RXFFST"].of(settings)
    return Receiver(level, latest, character, delay, options.oe_in_fifo_mode.unrecorded() != "overflow_only", left)


def fifo_bounds(receiver: Receiver, latency: Sequence[Term], routine: int) -> list[Bound]:
    """latency: of the service routine. routine: its length in ticks."""
    from ...f28335.sci.receiver import DEPTH

    late = total(latency)
    why = reasons(latency)
    if not receiver.keeps_up(late, routine):
        read = f"{len(receiver.reads)} words are read each time"
        if receiver.left >= receiver.level:
            read = f"{receiver.left} are left unread behind the frames: clear RXFFINT and PIEACK in the routine"
        why = why or f"the service routine does not keep up: the FIFO asks at {receiver.level} words, {read}"
    more = receiver.more(late, routine)
    most = receiver.level + more
    source = "a character lasts longer than latency and routine" * (not more) or "latency, routine; SCICCR, SCIHBAUD"
    words = (
        Term("words at which service is asked for", receiver.level, "SCIFFRX.RXFFIL", why),
        Term("words that come before they are read", more, source),
    )
    full = f"{most} words may want its {DEPTH} places" if most > DEPTH else ""
    unread = "oe_in_fifo_mode counts each word that finds another unread" * receiver.counts_unread
    lost = Term(f"words beyond {DEPTH}", 0, f"high-water {most}", why or full or unread)
    return [
        Bound("FIFO high-water", "fifo high-water", words, counted=True, special=True),
        Bound("overruns", "overruns", (lost,), counted=True, special=True),
    ]

"""One read of many scenarios: its START and the firmware's wait go in; when everything happens in it comes out.

    b(i)      cycle_at(start + needs(i) + held) + seen         byte i is needed: XRDY rises, or SCL is held from here
    w(i)      landing of the write of byte i, the last one of zeros that nobody asks for
    f(i)      max(b(i - 1), w(i - 1))                          I2CDXR is free for byte i: XRDY, at the first fetch there
    rise(i)   max(let go(i), tick(w(i) + release)) where w(i) >= b(i), else let go(i); held += rise(i) - let go(i)

Where a service routine comes between the looks at XRDY and SCD, and lasts until the STOP, SCD ends the last wait for
XRDY, and the zeros are not written.

It hangs for ever with SCL low where AAS has fallen at the repeated START before it was read, or where I2CSTR was read
to clear SCD when SDIR had risen already: writing it back clears SDIR, and the firmware waits for it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .clock import CpuClock, Ints
from .lanes import Lanes
from .terms import Terms


@dataclass
class Read:
    """Of each lane. hung: it never ends; then only `let_go` counts, from when on SCL is held, and `cleared`.

    stop: tick of its STOP. seen: cycle at which the firmware reads SCD. again: tick of the repeated START. response,
    held: ticks. margins: int64[bytes, lanes], ticks. cleared: ticks from the write of I2CSTR to the edge of SDIR.
    let_gos, rises: ticks of each byte, as SCL is let go and as it rises for its first bit. landed: of its write.
    waits: (its first fetch, the cycle of its flag) of each wait, as far as no interrupt moved it.
    """

    hung: NDArray[np.bool_]
    let_go: Ints
    stop: Ints
    seen: Ints
    again: Ints
    response: Ints
    held: Ints
    margins: Ints
    cleared: Ints
    let_gos: list[Ints]
    rises: list[Ints]
    landed: Ints
    waits: list[tuple[Ints, Ints]]


def read(terms: Terms, number: int, clock: CpuClock, lanes: Lanes, start: Ints, first: Ints) -> Read:
    """number: of the read in its round. start: tick of its START. first: cycle of the first fetch of the AAS wait."""
    bus, code = terms.bus[number], terms.reads[number]

    def flag(tick: Ints) -> Ints:
        return clock.cycle_at(tick) + terms.seen

    on_bus = np.array([bus.aas, bus.again, bus.rrdy, bus.sdir, *bus.needs, bus.stop])[:, None] + start
    addressed_at, again_at, pointer_at, asked_at, *needed_at, stop_at = flag(on_bus)
    waits = []

    def wait(begun: Ints, there: Ints, poll: int, fetched: int = 0) -> Ints:
        waits.append((begun, there))
        return lanes.wait(begun, there, poll, fetched)

    addressed = wait(first, addressed_at, terms.poll)
    missed = addressed >= again_at
    if missed.any():  # AAS rises again with the read address, and SDIR with it
        addressed = lanes.wait(addressed, np.where(missed, asked_at, addressed), terms.poll)
    begun, _ = lanes.code(addressed, code.pointer)
    pointer = wait(begun, pointer_at, terms.poll)
    begun, (looked, written) = lanes.code(pointer, code.clear)
    hung = missed | (looked >= asked_at)
    asked = wait(begun, asked_at, terms.poll)
    begun, (landed,) = lanes.code(asked, code.first)

    shift = np.zeros_like(start)  # by how much SCL was held so far, and with it all that comes
    moved = False
    held, response = shift, shift + terms.low
    writes, let_gos, rises = [landed], [], []
    for byte, need in enumerate(bus.needs):
        needed = start + need + shift
        from_here = flag(needed) if moved else needed_at[byte]
        let_go = rise = needed + terms.low
        late = landed >= from_here
        if late.any():
            moved = True
            rise = np.where(late, np.maximum(let_go, clock.tick(landed + terms.release)), let_go)
            shift = shift + rise - let_go
            held = np.maximum(held, rise - let_go)
            if not byte:
                response = rise - needed
        free = np.maximum(from_here, landed)
        if byte + 1 < len(bus.needs):
            ready = wait(begun, free, terms.poll_two)
        else:
            stop = start + bus.stop + shift
            over_at = flag(stop) if moved else stop_at
            waits.append((begun, free))
            ready, over, places = lanes.split(begun, free, terms.poll_two, terms.second, over_at)
        begun, (landed,) = lanes.code(ready, code.more[byte])
        writes.append(landed)
        let_gos.append(let_go)
        rises.append(rise)
    seen = wait(begun + terms.second, over_at, terms.poll_two, fetched=1)
    if over.size:
        seen[over] = writes[-1][over] = ready[over]
        lanes.back(over, places)
    landed = clock.tick(np.array(writes))
    margins = margins_of(terms, clock, np.array(let_gos), landed)
    cleared = start + bus.sdir - clock.tick(written)
    held_from = start + bus.needs[0] + terms.low
    again = start + bus.again
    return Read(hung, held_from, stop, seen, again, response, held, margins, cleared, let_gos, rises, landed, waits)


def margins_of(terms: Terms, clock: CpuClock, let_go: Ints, landed: Ints) -> Ints:
    """From each write to the latest instant that is soon enough. landed: ticks of writes, one more than bytes."""
    found: Ints = let_go - clock.tick(clock.cycle_at(landed[:-1]) + terms.margin)
    return found

"""State table of an I2C bus, which both decoders follow: that of streams and that of arrays.

    EVENTS >> 3 * (before << 2 | now) & 7     event between two samples; levels: bit 0 is SCL, bit 1 is SDA
    COUNTED[rises]                            bits that count if START or STOP comes after this number of SCL rises

START and STOP are changes of SDA with SCL high in both samples. If both lines change at once, SCL counts. The SCL
pulse in which START or STOP comes holds no bit, unless it is the ninth: the sender sampled the ACK when SCL rose.

Agents on the simulated bus have a table of their own, since the decoders are an oracle for them.

Source: UM10204 sections 3.1.3 to 3.1.6.
"""

from __future__ import annotations

SCL, SDA = 1, 2
BITS = 9  # of a byte, its ACK included

NOTHING, FALL, RISE, START, STOP = range(5)
KINDS = 7  # mask of these


def _event(before: int, now: int) -> int:
    if (before ^ now) & SCL:
        return RISE if now & SCL else FALL
    if before == now or not now & SCL:
        return NOTHING
    return STOP if now & SDA else START


EVENTS = sum(_event(pair >> 2, pair & 3) << 3 * pair for pair in range(16))
COUNTED = (0, *range(BITS - 1), BITS)

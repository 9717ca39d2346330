"""Events between two successive samples of an I2C bus: START, STOP, a rise or a fall of SCL.

    event = EVENTS >> 3 * (before << 2 | now) & 7      before, now: the levels, with SCL in bit 0 and SDA in bit 1

START and STOP are changes of SDA with SCL high in both samples. If both lines change at once, only the rise or fall of
SCL is an event: data may change with the fall of SCL (a hold time of 0), and a bit is the level of SDA while SCL is
high.

Source: UM10204 sections 3.1.3 and 3.1.4, Table 10 (tHD;DAT).
"""

from __future__ import annotations

SCL, SDA = 1, 2
IDLE = SCL | SDA

NOTHING, FALL, RISE, START, STOP = range(5)


def _event(before: int, now: int) -> int:
    if (before ^ now) & SCL:
        return RISE if now & SCL else FALL
    if before == now or not now & SCL:
        return NOTHING
    return STOP if now & SDA else START


# A table as one number: three bits for each pair of samples.
EVENTS = sum(_event(pair >> 2, pair & 3) << 3 * pair for pair in range(16))

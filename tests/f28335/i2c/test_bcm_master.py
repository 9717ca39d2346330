"""BCM affects only a slave-transmitter: lines, flags and requests of a master are equal with both values."""

from __future__ import annotations

import pytest

from ..i2c_bus import SLOT, Bench, Target

PROBES = 4  # per SCL period


def seen(bcm: int, mode: str, data: list[int]) -> list[tuple[int, ...]]:
    """Return status, requests and outputs of a master, four times per SCL period; bytes are written when XRDY is 1."""
    b = Bench(Target(gives=[0x12, 0x34]))
    b.w("I2CEMDR", bcm)
    b.w("I2CIER", 0x7F)
    b.mode(mode, count=2)
    waiting = list(data)
    found = []
    for _ in range(45 * PROBES):
        b.run(SLOT // PROBES)
        if waiting and b.flag("XRDY"):
            b.w("I2CDXR", waiting.pop(0))
        found.append((b.peek("I2CSTR"), b.peek("I2CISRC"), b.m.requests, b.m.out))
    return found


@pytest.mark.rule("I2C-111")
@pytest.mark.parametrize(
    ("mode", "data"),
    [("MST TRX STT STP", [0x5A, 0xA5]), ("MST TRX STT", [0x5A]), ("MST STT STP", []), ("MST TRX RM STT", [1, 2, 3])],
    ids=["transmitter", "transmitter that waits", "receiver", "repeat mode"],
)
def test_bcm_changes_nothing_for_a_master(mode: str, data: list[int]) -> None:
    assert seen(0, mode, data) == seen(1, mode, data)
    assert len(set(seen(1, mode, data))) > 8, "the observed values never change"

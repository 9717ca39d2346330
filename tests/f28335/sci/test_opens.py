"""The first sample that counts after SW RESET releases the receiver."""

from __future__ import annotations

import pytest

from tests.f28335.sci_rig import SciRig


def received(low_samples: int) -> int:
    """Return RXRDY for a line that is low at the end of SW RESET and for `low_samples` more SCICLK, then high."""
    rig = SciRig()
    rig.set(SWRESET=0)
    rig.wait(2)
    now = rig.align()
    rig.drive(now, "RXD", 0)
    rig.wait(sciclk=3)
    rig.set(SWRESET=1)
    rig.wait(sciclk=low_samples)
    rig.drive(rig.now, "RXD", 1)
    rig.wait(12)
    return rig.get("RXRDY")


@pytest.mark.rule("SCI-029", "SCI-207")
@pytest.mark.parametrize(("low_samples", "rxrdy"), [(3, 0), (4, 1), (5, 1)])
def test_the_first_sample_after_sw_reset_counts_for_a_start_bit(low_samples: int, rxrdy: int) -> None:
    assert received(low_samples) == rxrdy

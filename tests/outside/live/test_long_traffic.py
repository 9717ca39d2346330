"""Live traffic at full speed for long: what is kept does not grow with it. A day of it: `make explore`."""

from __future__ import annotations

import gc
import sys
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.outside import Session
from periph_sim.outside.live.case_for_line import case_for_line
from periph_sim.outside.live.loop import Loop
from periph_sim.outside.live.pacing import Pacer
from tests.outside.live.echo import written
from tests.profiles import explores

IMU = Path(__file__).parents[3] / "timing" / "imu_hil.toml"
GROWS = "lost flags"  # the one budget that keeps the time of each occurrence


class HostFrames:
    """A door that writes twelve bytes each 20 ms and reads what comes."""

    def __init__(self, session: Session) -> None:
        self.session, self.line = session, session.serial("scia")
        self.written = self.came = self._due = 0

    def files(self) -> list[int]:
        return []

    def turn(self) -> None:
        if self.session.now >= self._due:
            self._due += self.session.ticks("20 ms")
            self.line.write(bytes(12))
            self.written += 12
        self.came += len(self.line.read())


def passes(host: HostFrames, seconds: int) -> int:
    """The blocks of memory that Python holds then."""
    session = host.session
    Loop(session, Pacer(session.ticks_per_second, Fraction(0)), [host]).run(session.ticks(f"{seconds} s"))
    gc.collect()
    return sys.getallocatedblocks()


def test_nothing_grows_and_no_byte_is_lost(tmp_path: Path) -> None:
    host = HostFrames(Session(written(tmp_path), ("RX",), log=tmp_path / "live.jsonl"))
    first, last = passes(host, 1), passes(host, 3)
    assert last - first < 100, "blocks in 100 frames of 12 bytes"
    assert host.written == 151 * 12 == host.line.sent + host.line.waiting
    assert host.came >= 149 * 12


@pytest.mark.long
@pytest.mark.timeout(86_400)
def test_a_day_of_it() -> None:
    if not explores():
        pytest.skip("a day of traffic: make explore")
    ready = case_for_line(IMU, "scia")
    kept = tuple(budget for budget in ready.case.budget if budget.measure != GROWS)
    host = HostFrames(Session(ready.case.model_copy(update={"budget": kept}), ready.wires))
    first, last = passes(host, 3600), passes(host, 86_400)
    assert last - first < 20_000, "blocks, of 4.1 million frames"
    assert host.line.sent + host.line.waiting == host.written

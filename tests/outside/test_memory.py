"""The memory of a run does not grow with its length: objects are counted at two times.

`make explore` runs live traffic at full speed for a simulated day.
"""

from __future__ import annotations

import gc
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from periph_sim.imu.host_frame import MotionFrames
from periph_sim.outside import Session
from periph_sim.outside.live.case_for_line import case_for_line
from periph_sim.outside.live.loop import Loop
from periph_sim.outside.live.pacing import Pacer
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from periph_sim.timing.derived.origins import FrameHistory
from periph_sim.timing.measures.measure import Tally
from tests.outside.live.echo import written
from tests.outside.sessions import FIRMWARE, case
from tests.profiles import explores
from tests.reachable import held
from tests.scene.runs import TIMING

APART = 3  # seconds: 150 rounds, enough to reveal anything that is kept for each round
BOUNDED = (Tally, MotionFrames)  # other tests show that these do not grow
RISE_AND_FALL = 150  # objects of caches with a fixed size


@pytest.mark.parametrize("name", ["imu_hil", "imu_hil_published"])
def test_a_scene_with_its_budgets_holds_no_more_after_more_rounds(name: str):
    """Only the history of frames grows, by 28 bytes per frame, as documented."""
    scene = Scene(load(TIMING / f"{name}.toml"))
    second = scene.timebase.per_second
    scene.advance(scene.start + 2 * second)
    before, rounds = held(scene, but=(*BOUNDED, FrameHistory)), scene.bytes_on_bus()
    scene.advance(scene.start + (2 + APART) * second)
    assert scene.bytes_on_bus() - rounds > 3000
    assert abs(held(scene, but=(*BOUNDED, FrameHistory)) - before) < RISE_AND_FALL


def test_a_session_holds_no_more_after_more_traffic(tmp_path: Path):
    """The session has the load of a live run: frames, reads by a controller, a log, steps of a millisecond."""
    units: dict[str, Any] = {
        "logger": {"firmware": str(FIRMWARE / "uart_logger.py"), "modules": ["SCI-A"]},
        "chip": {"firmware": str(FIRMWARE / "responder.py"), "modules": ["I2C-A"]},
    }
    with Session(case(unit=units), ("SDA", "SCL", "RX", "TX"), log=tmp_path / "live.log") as session:
        line, master = session.serial("scia"), session.i2c
        step = session.ticks("1 ms")
        session.advance(step)  # the start-up of both is over

        def traffic(rounds: int) -> int:
            for _ in range(rounds):
                line.write(b"0123456789ab")
                assert master.transfer(0x50, b"\x00", 3) == bytes([1, 2, 3])
                session.advance(session.now + step)
                line.read()
            return held(session)

        before = traffic(20)
        assert abs(traffic(100) - before) < 40


IMU = Path(__file__).parents[3] / "timing" / "imu_hil.toml"
GROWS = "lost flags"  # the only budget that keeps the time of each occurrence


class HostFrames:
    """A door that writes twelve bytes every 20 ms and counts the received bytes."""

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
    """Run up to this time; return the number of memory blocks that Python has allocated."""
    session = host.session
    Loop(session, Pacer(session.ticks_per_second, Fraction(0)), [host]).run(session.ticks(f"{seconds} s"))
    gc.collect()
    return sys.getallocatedblocks()


def test_memory_does_not_grow_and_no_byte_is_lost(tmp_path: Path) -> None:
    host = HostFrames(Session(written(tmp_path), ("RX",), log=tmp_path / "live.jsonl"))
    first, last = passes(host, 1), passes(host, 3)
    assert last - first < 100, "blocks after 100 more frames of 12 bytes"
    assert host.written == 151 * 12 == host.line.sent + host.line.waiting
    assert host.came >= 149 * 12


@pytest.mark.long
@pytest.mark.timeout(86_400)
def test_memory_and_bytes_of_a_day() -> None:
    if not explores():
        pytest.skip("a day of traffic: make explore")
    ready = case_for_line(IMU, "scia")
    kept = tuple(budget for budget in ready.budget if budget.measure != GROWS)
    host = HostFrames(Session(ready.model_copy(update={"budget": kept})))
    first, last = passes(host, 3600), passes(host, 86_400)
    assert last - first < 20_000, "blocks after 4.1 million more frames"
    assert host.line.sent + host.line.waiting == host.written

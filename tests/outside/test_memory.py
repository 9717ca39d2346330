"""What a run keeps does not grow with it: objects that are held are counted at two times, minutes of rounds apart."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from periph_sim.imu.host_frame import MotionFrames
from periph_sim.outside.session import Session
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from periph_sim.timing.derived.origins import FrameHistory
from periph_sim.timing.measures.measure import Tally
from tests.outside.sessions import FIRMWARE, case
from tests.reachable import held
from tests.scene.runs import TIMING

APART = 3  # seconds: 150 rounds, in which all that is kept of each is seen
BOUNDED = (Tally, MotionFrames)  # of which tests of their own tell that
RISE_AND_FALL = 150  # objects: of caches of fixed length


@pytest.mark.parametrize("name", ["imu_hil", "imu_hil_published"])
def test_a_scene_with_its_budgets_holds_no_more_after_more_rounds(name: str):
    """But for the history of frames, which grows by 28 bytes a frame, as it says."""
    scene = Scene(load(TIMING / f"{name}.toml"))
    second = scene.timebase.per_second
    scene.advance(scene.start + 2 * second)
    before, rounds = held(scene, but=(*BOUNDED, FrameHistory)), scene.bytes_on_bus()
    scene.advance(scene.start + (2 + APART) * second)
    assert scene.bytes_on_bus() - rounds > 3000
    assert abs(held(scene, but=(*BOUNDED, FrameHistory)) - before) < RISE_AND_FALL


def test_a_session_holds_no_more_after_more_traffic(tmp_path: Path):
    """Frames by serial port, reads by a controller, a log, steps of a millisecond: what a live run does."""
    units: dict[str, Any] = {
        "logger": {"firmware": str(FIRMWARE / "uart_logger.py"), "modules": ["SCI-A"]},
        "chip": {"firmware": str(FIRMWARE / "responder.py"), "modules": ["I2C-A"]},
    }
    with Session(case(unit=units), ("SDA", "SCL", "RX", "TX"), log=tmp_path / "live.log") as session:
        line, master = session.serial("scia"), session.i2c
        step = session.ticks("1 ms")
        session.advance(step)  # both have started

        def traffic(rounds: int) -> int:
            for _ in range(rounds):
                line.write(b"0123456789ab")
                assert master.transfer(0x50, b"\x00", 3) == bytes([1, 2, 3])
                session.advance(session.now + step)
                line.read()
            return held(session)

        before = traffic(20)
        assert abs(traffic(100) - before) < 40

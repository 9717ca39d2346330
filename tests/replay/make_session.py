"""A run of the IMU/HIL case as an analyser would capture it: `python -m tests.replay.make_session` writes the trace.

timing/imu_hil_published.toml --run--> edges of SCL, SDA, RX --sampled--> Capture, traces/imu_session.sr
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

from periph_sim.scene.case.load import load
from periph_sim.scene.result import Result
from periph_sim.scene.scene import Scene
from periph_sim.traces.capture.capture import Capture, Channel, channel_of
from tests.scene.runs import TIMING, Edges
from tests.traces.formats.writers import sr_bytes

FILE = Path(__file__).resolve().parents[2] / "traces" / "imu_session.sr"
LINES = ("SCL", "SDA", "RX")


def ran(seconds: Fraction, *changes: str) -> tuple[Result, Capture]:
    """Run the case and return the result and its edges, one position a tick."""
    edges = Edges()
    scene = Scene(load(TIMING / "imu_hil_published.toml", list(changes)), edges.subscribe)
    result = scene.run(seconds)
    return result, edges.capture(scene.kernel.now + 1)


def sampled(capture: Capture, rate: int) -> Capture:
    """Return the lines as sampled by an analyser: each edge is at the first sample at or after it."""
    assert capture.rate is not None
    step = capture.rate / rate
    length = int(capture.length / step)
    channels: list[Channel] = []
    for name in LINES:
        line = capture.channel(name)
        at = [-int(-edge // step) for edge in line.edges.tolist()]
        channels.append(channel_of(name, len(channels), [0, *at], [line.initial, *line.levels.tolist()], length))
    return Capture(Path("sampled"), Fraction(rate), length, tuple(channels))


def samples(capture: Capture) -> bytes:
    """Return the samples of a capture, with channel k in bit k."""
    found = bytearray(capture.length)
    for bit, line in enumerate(capture.channels):
        level, last = line.initial, 0
        for at, after in [*zip(line.edges.tolist(), line.levels.tolist(), strict=True), (capture.length, 0)]:
            if level:
                for place in range(last, at):
                    found[place] |= 1 << bit
            level, last = after, at
    return bytes(found)


if __name__ == "__main__":
    _, edges = ran(Fraction(50, 1000))
    FILE.write_bytes(sr_bytes(list(LINES), "1 MHz", samples(sampled(edges, 1_000_000))))

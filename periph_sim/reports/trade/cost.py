"""What a level costs: a case goes in; CPU time, events and memory of its run come out.

No records are made but those that the case's budgets need: a recorded run is another one.
"""

from __future__ import annotations

import gc
import tracemalloc
from dataclasses import dataclass
from fractions import Fraction
from time import process_time

from ...scene.case.model import Case
from ...scene.result import BYTE_LEVEL, FRAMES, FRAMES_PASSED
from ...scene.scene import Scene

TRACED = Fraction(2, 100)  # seconds of the scene in which allocations are traced: tracing takes several times as long


@dataclass(frozen=True)
class Cost:
    """cpu_s: of the run, building apart. memory: bytes that Python had allocated at most, by tracemalloc, from before
    the scene was built to the end of the first TRACED seconds. byte_level: I2C bytes that passed at byte level.
    sci_frames, sci_frames_passed: on UART lines, and above edges. share: both as a phrase.
    """

    simulated_s: float
    cpu_s: float
    events: int
    i2c_bytes: int
    sci_bytes: int
    byte_level: int
    memory: int
    sci_frames: int = 0
    sci_frames_passed: int = 0
    share: str = ""

    @property
    def cpu_per_second(self) -> float:
        return self.cpu_s / self.simulated_s if self.simulated_s else 0.0

    @property
    def bytes_per_cpu_second(self) -> float:
        return self.i2c_bytes / self.cpu_s if self.cpu_s else 0.0

    @property
    def events_per_byte(self) -> float:
        """Of bytes on both buses; 0 where there was none."""
        count = self.i2c_bytes + self.sci_bytes
        return self.events / count if count else 0.0


def cost_of(case: Case, length: Fraction, traced: bool = True) -> Cost:
    """Two runs: one timed, and the begin of one traced, where memory is asked for; else it is 0."""
    scene = Scene(case)
    gc.collect()
    began = process_time()
    result = scene.run(length)
    cpu = process_time() - began
    memory = _memory(case, length) if traced else 0
    passed, frames, of_frames = (result.counts.get(name, 0) for name in (BYTE_LEVEL, FRAMES, FRAMES_PASSED))
    return Cost(
        result.simulated_s,
        cpu,
        result.events,
        result.wire_bytes,
        result.sci_bytes + result.sci_bytes_sent,
        passed,
        memory,
        sci_frames=frames,
        sci_frames_passed=of_frames,
        share=result.share_above_edges,
    )


def _memory(case: Case, length: Fraction) -> int:
    gc.collect()
    tracemalloc.start()
    try:
        Scene(case).run(min(length, TRACED))
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()

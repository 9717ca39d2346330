"""Two F28335 on one bus, one the master and one three slaves, each on its own crystal."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.scene.case.load import load
from periph_sim.scene.result import Result
from periph_sim.scene.scene import Scene
from periph_sim.traces.decode import i2c
from tests.scene.runs import TIMING, Edges

SECONDS = Fraction(95, 1000)
ROUNDS = 4  # at 20, 40, 60 and 80 ms by the head's timer
CHIPS = {0x68: (0x1D, "111213141516"), 0x53: (0x32, "212223242526"), 0x1E: (0x03, "313233343536")}


class Both:
    """The case run with two ppm errors: what the head's CPU read, and what went over the wires."""

    def __init__(self, *changes: str) -> None:
        self.drr: list[int] = []  # I2CDRR as the head's CPU read it
        self.edges = Edges()
        self.scene = Scene(load(TIMING / "two_dsps.toml", list(changes)), self._subscribe)
        self.result: Result = self.scene.run(SECONDS)

    def _subscribe(self, recorder: Recorder, timebase: Timebase) -> None:
        recorder.subscribe([Kind.ACCESS], self._keep)
        self.edges.subscribe(recorder, timebase)

    def _keep(self, record: Record) -> None:
        if record.where == "head" and record.what == "R I2C-A.I2CDRR":
            self.drr.append(record.value)

    def on_the_wires(self) -> list[tuple[int | None, bytes, int | None, bytes]]:
        """Complete transfers: address written to and bytes, address read from and bytes."""
        found = []
        for transfer in i2c.transfers(self.edges.capture(self.scene.kernel.now + 1)):
            if transfer.complete and len(transfer.phases) == 2:
                asked, answer = transfer.phases
                assert (asked.read, answer.read) == (False, True)
                found.append((asked.address, bytes(asked.data), answer.address, bytes(answer.data)))
        return found


def ppm(head: int, imu: int) -> tuple[str, str]:
    return f"unit.head.ppm={head}", f"unit.imu.ppm={imu}"


@pytest.mark.parametrize(("head", "imu"), [(0, 0), (50, -50), (-300, 300), (300, -300), (7, 8), (0, 5000)])
def test_every_byte_arrives_right_whatever_the_crystals(head: int, imu: int):
    both = Both(*ppm(head, imu))
    one_round = [(chip, bytes([pointer]), chip, bytes.fromhex(data)) for chip, (pointer, data) in CHIPS.items()]
    assert both.on_the_wires() == one_round * ROUNDS
    assert bytes(both.drr) == b"".join(bytes.fromhex(data) for _, data in CHIPS.values()) * ROUNDS
    assert both.result.verdict == "pass" and both.result.stuck == []


def test_the_bus_runs_at_the_master_s_rate_by_its_own_crystal():
    """A round takes the head the same number of its own cycles, so its length in time goes with its ppm."""
    slow, fast = (Both(*ppm(error, 0)).result.budgets[1].worst for error in (-5000, 5000))
    assert isinstance(slow, float) and isinstance(fast, float)
    assert slow / fast == pytest.approx(1.005 / 0.995, rel=2e-4)


def test_phase_between_the_crystals_moves_from_round_to_round():
    """Unequal crystals try out one phase after the other: edges fall anywhere between the slave's cycles."""
    both = Both(*ppm(50, 0))
    clock = both.scene.units["imu"].clock
    capture = both.edges.capture(both.scene.kernel.now + 1)
    phases = {int(tick) - clock.tick(clock.cycle_at(int(tick)) - 1) for tick in capture.channel("SCL").edges}
    assert phases == set(range(1, 21))  # a cycle has 20 ticks


def test_a_chip_that_is_not_there_is_told_by_the_wire_and_the_budget():
    """The head asks accelerometer first, the emulator expects the gyroscope: rounds are shorter than 2.4 ms."""
    both = Both("unit.head.settings.order=[0x53, 0x68, 0x1e]")
    assert [chip for chip, *_ in both.on_the_wires()] == [0x68, 0x53, 0x1E, 0x68, 0x53, 0x1E]
    assert [v.name for v in both.result.budgets if v.verdict == "fail"] == ["three chips answered"]


def test_a_slave_that_never_answers_does_not_hang_the_master():
    both = Both("unit.imu.settings.model_cost=1 s")
    assert both.on_the_wires() == [] and both.drr == []
    assert both.scene.wires["SCL"].level == 1 and both.scene.wires["SDA"].level == 1

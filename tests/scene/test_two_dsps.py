"""Two F28335 on one bus, a master and one as three slaves, each on its own crystal, and a host that sends to one."""

from __future__ import annotations

from fractions import Fraction
from itertools import count

import pytest

from periph_sim import Firmware, Result, Scene, Verdict, load
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.traces.decode import i2c
from tests.scene.late_code import WRITE, replaced
from tests.scene.runs import TIMING, Edges

SECONDS = Fraction(95, 1000)
ROUNDS = 4  # at 20, 40, 60 and 80 ms by the head's timer
CHIPS = {0x68: 0x1D, 0x53: 0x32, 0x1E: 0x03}  # address -> pointer
READ = ROUNDS * len(CHIPS) * 6  # bytes


class Both:
    """A run of the case with changes: the bytes that the head's CPU read, and the transfers on the wires."""

    def __init__(self, *changes: str, **programs: Firmware) -> None:
        self.drr: list[int] = []  # I2CDRR as the head's CPU read it
        self.edges = Edges()
        self.scene = Scene(load(TIMING / "two_dsps.toml", list(changes)), self._subscribe, programs=programs)
        self.result: Result = self.scene.run(SECONDS)

    def _subscribe(self, recorder: Recorder, timebase: Timebase) -> None:
        recorder.subscribe([Kind.ACCESS], self._keep)
        self.edges.subscribe(recorder, timebase)

    def _keep(self, record: Record) -> None:
        if record.where == "head" and record.what == "R I2C-A.I2CDRR":
            self.drr.append(record.value)

    def verdict(self, budget: str) -> Verdict:
        (verdict,) = (verdict for verdict in self.result.budgets if verdict.name == budget)
        return verdict

    def broken(self) -> list[str]:
        return [verdict.name for verdict in self.result.budgets if verdict.verdict == "fail"]

    def on_the_wires(self) -> list[tuple[int | None, bytes, int | None, bytes]]:
        """Return the complete transfers: address and bytes of the write, address and bytes of the read."""
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
    """The bytes on the wires are those of the host's frames, and the head's CPU reads the bytes on the wires."""
    both = Both(*ppm(head, imu))
    transfers = both.on_the_wires()
    one_round = [(chip, bytes([pointer]), chip) for chip, pointer in CHIPS.items()]
    assert [transfer[:3] for transfer in transfers] == one_round * ROUNDS
    assert bytes(both.drr) == b"".join(data for *_, data in transfers) and len(both.drr) == READ
    assert both.result.verdict == "pass" and both.result.stuck == []
    assert both.verdict("wrong bytes").counted == str(READ)


def test_one_wrong_byte_of_the_firmware_breaks_the_budget():
    """The tenth byte that the emulator writes is the third of the second read, the accelerometer's."""
    written = count(1)
    both = Both(imu=replaced("imu_hil", WRITE, f"{WRITE} ^ flipped()", flipped=lambda: next(written) == 10))
    assert both.verdict("wrong bytes").worst == 1 and both.broken() == ["wrong bytes"]
    assert both.result.wrong == {"accelerometer byte 2": 1}


def test_a_byte_that_the_firmware_loses_breaks_the_budget_of_overruns():
    both = Both(imu=replaced("imu_hil", "sci.SCIFFRX.RXFFINTCLR = 1", "pass"))
    assert "SCI overruns" in both.broken()


@pytest.mark.parametrize(
    ("change", "budget"), [("host.frames=1", "data age"), ("host.motion.angles.2.frequency='7 Hz'", "overflows")]
)
def test_a_host_that_dies_or_turns_too_fast_breaks_its_budget_alone(change: str, budget: str):
    assert Both(change).broken() == [budget]


def test_the_bus_runs_at_the_master_s_rate_by_its_own_crystal():
    """A round takes the head the same number of its own cycles, so its duration depends on the head's ppm."""
    slow, fast = (Both(*ppm(error, 0)).result.budgets[1].worst for error in (-5000, 5000))
    assert slow / fast == pytest.approx(1.005 / 0.995, rel=2e-4)


def test_the_phase_between_the_crystals_changes_from_round_to_round():
    """With unequal crystals, edges occur at every phase of the slave's cycles."""
    both = Both(*ppm(50, 0))
    clock = both.scene.units["imu"].clock
    capture = both.edges.capture(both.scene.kernel.now + 1)
    phases = {int(tick) - clock.tick(clock.cycle_at(int(tick)) - 1) for tick in capture.channel("SCL").edges}
    assert phases == set(range(1, 21))  # a cycle has 20 ticks


def test_requests_in_another_order_break_budgets():
    """The head asks the accelerometer first, the emulator expects the gyroscope: rounds are shorter than 2.4 ms."""
    both = Both("unit.head.settings.order=[0x53, 0x68, 0x1e]")
    assert [chip for chip, *_ in both.on_the_wires()] == [0x68, 0x53, 0x1E, 0x68, 0x53, 0x1E]
    assert both.broken() == ["three chips answered", "missed rounds", "nacked rounds", "data age"]


def test_a_slave_that_never_answers_does_not_hang_the_master():
    both = Both("unit.imu.settings.model_cost=1 s")
    assert both.on_the_wires() == [] and both.drr == [] and "nacked rounds" in both.broken()
    assert both.scene.wires["SCL"].level == 1 and both.scene.wires["SDA"].level == 1

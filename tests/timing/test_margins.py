"""The margin of each write of I2CDXR, and the time a unit holds SCL, compared with a second computation."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from periph_sim import Dsp
from periph_sim.core.records import Kind
from periph_sim.core.time import NO_TIME
from periph_sim.timing.language.scope import BadEvent
from periph_sim.timing.measures.factory import measure_named
from tests.scene.runs import run_file
from tests.scene.small import scene_with, sentence_of, started_i2c
from tests.timing import test_rounds
from tests.timing.events_by_hand import BARE, ONE

BUDGETS = (
    'budget=[{name="m", measure="margin of I2CDXR", min="0 s"}, {name="h", measure="SCL held per transfer", max="9 s"}]'
)
LATE = ("unit.dsp.settings.frame_cost=110 us",)  # longer than the byte that I2CDXR holds in advance


class Ran(test_rounds.Ran):
    """A run with all its records. margins: the margin of each write by its tick."""

    def __init__(self, name: str, seconds: str, *changes: str) -> None:
        super().__init__(name, seconds, BUDGETS, *changes)
        self.margins = {at: value for value, at in self.values("m")}
        self.held = self.scene.limits[1].measure


def by_hand(ran: Ran) -> dict[int, int]:
    """Map the write of each byte that was sent to its time before the controller's release of SCL.

    Byte n has the n-th write. If the controller had to wait for a byte of a read, every write between the read address
    and the STOP is included, except for the last one, which no byte uses.
    """
    found: dict[int, int] = {}
    writes: list[int] = []
    reading, released = False, NO_TIME
    bits = needed = 0
    for r in ran.records:
        if r.kind is Kind.BUS and r.what in ("START", "repeated START"):
            reading, bits, needed, writes = False, 0, 0, []
        elif r.kind is Kind.BUS and r.what == "address":
            reading = bool(r.value & 2) and not r.value & 1
            bits = 0
        elif r.kind is Kind.BUS and r.what == "byte":
            reading = reading and not r.value & 1
            bits = 0
        elif r.kind is Kind.ACCESS and r.what == "W I2C-A.I2CDXR":
            writes.append(r.tick)
        elif r.where == "SCL" and r.kind is Kind.EDGE and not r.value:
            released = NO_TIME
        elif r.where == "SCL" and r.kind is Kind.HOLD and r.text == "dsp.GPIO33":
            released = r.tick
        elif r.where == "SCL" and r.kind is Kind.EDGE and r.value:
            if reading and bits == 0:
                found[writes[needed]] = (r.tick if released == NO_TIME else released) - writes[needed]
                needed += 1
            bits += 1
    return found


@pytest.mark.parametrize(
    ("name", "seconds", "changes"), [("imu_hil_published", "0.06", ()), ("imu_hil_drift", "0.47", LATE)]
)
def test_the_margin_is_the_time_to_the_release_by_the_controller_minus_that_of_the_module(
    name: str, seconds: str, changes: tuple[str, ...]
):
    ran = Ran(name, seconds, *changes)
    wanted = by_hand(ran)
    delay = ran.scene.measured.i2c_release_delay("dsp")
    assert len(wanted) >= 54 and ran.margins == {at: value - delay(at) for at, value in wanted.items()}


def test_the_margin_does_not_depend_on_when_the_measure_is_notified():
    """A clock that is off has cycles of two lengths. Cycles after the write count, not those at the notification."""
    budget = "budget=[{name='margin',measure='margin of I2CDXR',min='3448.2 ns'}]"
    runs = [run_file("imu_hil_400k", "0.17", "seed=28", budget, *change) for change in ((), ("disable=bits",))]
    skipping, by_edges = (ran.result.budgets[0] for ran in runs)
    assert by_edges == skipping and (by_edges.worst, by_edges.verdict) == (3.448, "fail")


def test_if_scl_is_held_the_margin_is_the_negative_of_that_time():
    ran = Ran("imu_hil_drift", "0.47", *LATE)
    margin, held = ran.result.budgets
    assert margin.broken and held.worst == -margin.worst > 50
    assert sum(value < 0 for value in ran.margins.values()) == sum(held > 0 for held in ran.held.all_kept()[0].tolist())


def test_scl_is_not_held_if_each_write_is_in_time():
    ran = Ran("imu_hil_published", "0.06")
    assert ran.result.verdict == "pass" and ran.held.worst == 0 and ran.held.count == 9
    assert min(ran.margins.values()) > 0 and len(ran.margins) == 54


def test_a_bus_held_until_the_end_counts():
    """SDIR is cleared along with SCD, and the firmware waits for it until the end of the run."""
    ran = Ran("imu_hil_drift", "0.47", "unit.dsp.settings.frame_cost=200 us")
    assert ran.scene.stuck.hangs() or ran.scene.held_since() != NO_TIME
    margin, held = ran.result.budgets
    assert margin.broken and held.worst >= -margin.worst > 1000


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("margin of I2CDRR", "'margin of I2CDRR': only I2CDXR has a margin; write margin of I2CDXR"),
        ("margin of imu:I2CDXR", "there is no unit 'imu'; it has dsp"),
        ("margin", "'margin' ends where of is expected"),
        ("SCL held", "'SCL held' ends where per is expected"),
        ("SCL held per transfer by imu", "there is no unit 'imu'"),
    ],
)
def test_a_measure_without_a_margin_is_rejected(text: str, sentence: str):
    assert sentence_of(BadEvent, lambda: measure_named(text, ONE)).startswith(sentence)
    assert measure_named("margin of dsp:I2CDXR", BARE).series


def answers(delay: int) -> Callable[[Dsp], None]:
    """Firmware that serves one read of four bytes, with `delay` cycles before each write."""

    def main(dsp: Dsp) -> None:
        i2c = started_i2c(dsp, 0x50)
        dsp.spin(lambda: i2c.I2CSTR.SDIR == 1)
        i2c.I2CMDR.TRX = 1
        for byte in range(4):
            dsp.compute(delay)
            i2c.I2CDXR.all = byte
            dsp.spin(lambda: i2c.I2CSTR.XRDY == 1)
        dsp.spin(lambda: i2c.I2CSTR.SCD == 1)

    return main


def test_twenty_cycles_before_each_write_reduce_the_margin_by_twenty_cycles():
    """The second byte can be written when the first has moved to the shift register, so both delays affect it."""

    def margins(delay: int) -> list[int]:
        request = {"address": 0x50, "count": 4, "expect": "00 01 02 03"}
        budget = {"name": "m", "measure": "margin of I2CDXR", "min": "0 s"}
        scene = scene_with(answers(delay), ["I2C-A"], controller={"rounds": 1, "request": [request]}, budget=[budget])
        scene.limits[0].measure.keep()
        scene.run()
        return [int(value) // 20 for value in scene.limits[0].measure.all_kept()[0]]  # cycles

    plain, later = margins(0), margins(20)
    assert len(plain) == 4 and min(later) > 0
    assert plain[0] - later[0] == 20
    assert all(0 <= a - b - 20 <= 21 for a, b in zip(plain[1:], later[1:], strict=True))  # a pass of a poll at most

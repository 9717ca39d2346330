"""Causes in the records of a run: the edge before the filter, the access before the pin, the clock edge of an answer.

edge --> noise filter --> flag            CPU write --> pin, a cycle later            SCL falls --> next bit on SDA
"""

from __future__ import annotations

from collections import defaultdict
from fractions import Fraction

import pytest

from periph_sim import Case, Dsp, Firmware, load
from periph_sim.core.records import RECORDED, Kind, Record
from tests.scene import runs
from tests.scene.runs import TIMING
from tests.scene.small import case, given, started_i2c, unit

CYCLE = 20  # ticks
FILTER = 15  # cycles: one module clock, IPSC = 14


class Causes:
    """Records of a run, each with its cause."""

    def __init__(self, records: list[Record]) -> None:
        self.by_number = {record.number: record for record in records}
        self.records = records

    def find(self, kind: Kind, what: str, where: str = "") -> list[tuple[Record, Record | None]]:
        found = [r for r in self.records if r.kind is kind and r.what == what and where in (r.where, "")]
        return [(record, self.by_number.get(record.cause)) for record in found]


def recorded(
    table: Case, seconds: str, programs: dict[str, Firmware] | None = None, kinds: frozenset[Kind] = frozenset(RECORDED)
) -> Causes:
    scene, records = runs.recorded(table, kinds, programs)
    scene.run(Fraction(seconds))
    return Causes(records)


def test_the_cause_of_a_level_is_the_last_write_also_without_records_of_edges():
    """Without records of edges, the first write that changed any pin of the unit was once recorded as the cause."""
    kinds = frozenset({Kind.ACCESS, Kind.FLAG})
    found = recorded(load(TIMING / "imu_hil.toml"), "0.01", kinds=kinds).find(Kind.FLAG, "GPBDAT.GPIO34")
    causes = {(record.value, cause.what) for record, cause in found if cause is not None}
    assert causes == {(0, "W GPIO.GPBDIR"), (1, "W GPIO.GPBSET"), (0, "W GPIO.GPBCLEAR")}


@pytest.fixture(scope="module")
def causes() -> Causes:
    return recorded(load(TIMING / "imu_hil_published.toml", []), "0.1")


@pytest.mark.parametrize(
    ("flag", "value", "wire", "level"),
    [
        ("AAS", 1, "SCL", 0),
        ("SDIR", 1, "SCL", 0),
        ("RRDY", 1, "SCL", 0),
        ("NACK", 1, "SCL", 1),
        ("SCD", 1, "SDA", 1),
        ("BB", 1, "SDA", 0),
        ("BB", 0, "SDA", 1),
    ],
)
def test_a_flag_names_the_edge_that_came_through_the_filter_in_its_cycle(causes, flag, value, wire, level):
    found = [pair for pair in causes.find(Kind.FLAG, f"I2CSTR.{flag}") if pair[0].value == value]
    assert len(found) >= 15
    for record, cause in found:
        assert (cause.kind, cause.where, cause.value) == (Kind.EDGE, wire, level)
        assert record.tick - cause.tick == pytest.approx(FILTER * CYCLE, abs=CYCLE)  # edges fall between cycles


def test_a_flag_that_a_write_changes_names_the_write(causes):
    for record, cause in causes.find(Kind.FLAG, "I2CCNT.ICDC"):
        assert (cause.what, cause.tick) == ("W I2C-A.I2CCNT", record.tick)


def test_a_pin_names_the_write_that_moved_it_a_cycle_before(causes):
    whys = defaultdict(set)
    for edge, cause in causes.find(Kind.EDGE, "level", "MODEL")[1:]:
        whys[edge.value].add((cause.what, (edge.tick - cause.tick) // CYCLE))
    assert whys == {1: {("W GPIO.GPBSET", 1)}, 0: {("W GPIO.GPBCLEAR", 1)}}


def test_the_bits_that_the_module_sends_name_the_falling_clock(causes):
    sent = [(e, c) for e, c in causes.find(Kind.EDGE, "level", "SDA") if c is not None]
    assert len(sent) > 100
    for edge, cause in sent:
        assert (cause.where, cause.value) == ("SCL", 0)
        assert edge.tick - cause.tick == pytest.approx((FILTER + 1) * CYCLE, abs=CYCLE)


@pytest.mark.parametrize("data", [0x5A, 0xA5])
def test_a_stretch_ends_with_the_write_of_i2cdxr(data: int):
    def slow(dsp: Dsp) -> None:
        i2c = started_i2c(dsp, own_address=0x68)
        dsp.spin(lambda: i2c.I2CSTR.AAS == 1)
        dsp.compute(45_000)  # 300 us
        i2c.I2CDXR.all = data
        dsp.spin(lambda: i2c.I2CSTR.NACK == 1)

    head = {"first": "1 ms", "rounds": 1, "request": [{"address": 0x68, "count": 1}]}
    causes = recorded(case(unit={"dsp": unit("I2C-A")}, controller=head), "0.01", given(dsp=slow))
    (let_go,) = [c for e, c in causes.find(Kind.EDGE, "level", "SCL") if e.value == 1 and c is not None]
    if data >> 7 == 0:  # the first bit changes SDA before SCL is released
        assert (let_go.where, let_go.value, let_go.text) == ("SDA", 0, "dsp.SDAA")
        let_go = causes.by_number[let_go.cause]
    assert let_go.what == "W I2C-A.I2CDXR"


def test_the_byte_in_the_fifo_names_the_last_edge_that_had_passed_the_synchroniser(causes):
    edges = [r for r in causes.records if r.kind is Kind.EDGE and r.where == "RX"]
    found = [(f, c) for f, c in causes.find(Kind.FLAG, "SCIFFRX.RXFFST") if c is not None and c.kind is Kind.EDGE]
    assert len(found) >= 50
    for flag, cause in found:
        assert cause == [edge for edge in edges if edge.tick <= flag.tick - 2 * CYCLE][-1]

"""Records kept near a moment of a divergence: which ones, and how many."""

from __future__ import annotations

import pytest

from periph_sim.core.records import Kind, Recorder
from periph_sim.core.time import Timebase
from periph_sim.replay.divergence_history import FlagHistory

AAS, XRDY, IRS, OTHER = "I2CSTR.AAS", "I2CSTR.XRDY", "I2CMDR.IRS", "I2CCNT.ICDC"


def records_kept(
    history: FlagHistory, moment: tuple[int, int], *records: tuple[int, Kind, str, str]
) -> list[tuple[int, str]]:
    recorder = Recorder()
    history.subscribe(recorder, Timebase())
    for tick, kind, where, what in records:
        recorder.emit(tick, kind, where, what, 1)
    return [(record.tick, record.what) for record in history.records_near(moment)]


def flag(tick: int, what: str, where: str = "dsp.I2C-A") -> tuple[int, Kind, str, str]:
    return tick, Kind.FLAG, where, what


def test_flags_and_accesses_of_the_module_are_kept_up_to_the_end_of_the_moment():
    history = FlagHistory([(100, 120)], "dsp", "I2C-A")
    records = [
        flag(10, AAS),
        flag(20, OTHER),
        flag(30, AAS, "imu.I2C-A"),
        flag(40, IRS),
        (50, Kind.ACCESS, "dsp", "W I2C-A.I2CDXR"),
        (60, Kind.ACCESS, "dsp", "R SCI-A.SCIRXBUF"),
        (70, Kind.ACCESS, "imu", "W I2C-A.I2CDXR"),
        flag(120, XRDY),
        flag(121, XRDY),
    ]
    assert records_kept(history, (100, 120), *records) == [(10, AAS), (40, IRS), (50, "W I2C-A.I2CDXR"), (120, XRDY)]


def test_a_moment_within_another_ends_at_its_own_end():
    history = FlagHistory([(100, 200), (150, 160)], "dsp", "I2C-A")
    records = [flag(110, AAS), flag(155, IRS), flag(180, XRDY), flag(210, AAS)]
    assert records_kept(history, (150, 160), *records) == [(110, AAS), (155, IRS)]
    assert [record.tick for record in history.records_near((100, 200))] == [110, 155, 180]


def test_records_of_a_busy_register_do_not_replace_those_of_another():
    history = FlagHistory([(1000, 1000)], "dsp", "I2C-A", keep=3)
    records = [flag(1, AAS), *(flag(tick, XRDY) for tick in range(2, 900))]
    assert records_kept(history, (1000, 1000), *records) == [(1, AAS), (897, XRDY), (898, XRDY), (899, XRDY)]


def test_24_changes_of_each_field_are_kept():
    history = FlagHistory([(100, 100)], "dsp", "I2C-A")
    assert records_kept(history, (100, 100), *(flag(tick, AAS) for tick in range(30))) == [
        (n, AAS) for n in range(6, 30)
    ]


@pytest.mark.parametrize(
    ("module", "shown"),
    [("I2C-A", ["I2CSTR.AAS", "I2CMDR.IRS"]), ("SCI-A", ["SCIRXST.FE", "SCIFFRX.RXFFST", "SCICTL1.RXENA"])],
)
def test_records_of_these_registers_are_kept_for_each_module(module: str, shown: list[str]):
    every = ["I2CSTR.AAS", "I2CMDR.IRS", "I2CCNT.ICDC", "SCIRXST.FE", "SCIFFRX.RXFFST", "SCICTL1.RXENA", "SCIBAUD.X"]
    history = FlagHistory([(100, 100)], "dsp", module)
    records = [flag(number, what, f"dsp.{module}") for number, what in enumerate(every)]
    assert [what for _, what in records_kept(history, (100, 100), *records)] == shown


def test_each_of_several_moments_has_its_own_records():
    history = FlagHistory([(50, 60), (10, 20)], "dsp", "I2C-A")
    records_kept(history, (10, 20), flag(15, AAS), flag(30, XRDY), flag(70, IRS))
    assert [record.tick for record in history.records_near((10, 20))] == [15]
    assert [record.tick for record in history.records_near((50, 60))] == [15, 30]

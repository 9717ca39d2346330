"""Where a unit is the master: a device that stretches is who held SCL, and polls of one that is busy are one line."""

from __future__ import annotations

from typing import Any

from periph_sim.interfaces.reports.explain.chain import Chain, text
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import Case
from tests.interfaces.reports.explain.made import run_and_explain, steps_of
from tests.scene.runs import TIMING

SCRIPT = ["50 W 00 10 11 22", "50 W", "50 W", "50 W", "50 W 00 10 Sr 50 R 2"]
REQUEST = {"address": 0x50, "pointer": 0, "count": 0}
REQUESTS = [{**REQUEST, "write": "10 11 22"}, {**REQUEST, "write": "10", "count": 2}]


def told(measure: str, **device: Any) -> str:
    """The explanation of one budget of a script of transfers, as text."""
    return "\n".join(text(chain(measure, SCRIPT, REQUESTS, **device)))


def chain(measure: str, script: list[str], requests: list[dict[str, Any]], **device: Any) -> Chain:
    settings = {"script": script, "pauses": ["0 s"] * (len(script) - 1) + ["100 us"]}
    unit = {"firmware": "captured_master", "modules": ["I2C-A"], "settings": settings}
    tables = {
        "name": "script",
        "duration": "2 ms",
        "unit": {"dsp": unit},
        "device": {"memory": {"model": "24lc64", "write_time": "400 us", **device}},
        "rounds": {
            "period": "2 ms",
            "ack_polling": True,
            "request": requests,
        },
        "budget": [{"name": "it", "measure": measure, "max": 0 if measure == "wrong bytes" else "1 s"}],
    }
    return run_and_explain(Case.model_validate(tables))["it"].chain


def test_polls_that_are_refused_are_one_line():
    shown = told("round")
    assert shown.count("not acknowledged") == 1
    assert "memory (0x50 W), not acknowledged, 3 times" in shown


# Bytes that the device sends ---------------------------------------------------------


def read_back(written: str, word: str, expect: str) -> Chain:
    """Two bytes are written, and two read from a word address of one byte, which are not those expected."""
    script = [f"50 W 00 {written}", "50 W", "50 W", "50 W", f"50 W 00 {word} Sr 50 R 2"]
    asked = [{**REQUEST, "write": written}, {**REQUEST, "write": word, "count": 2, "expect": expect}]
    return chain("wrong bytes", script, asked)


def test_a_byte_that_a_memory_sends_is_told_with_the_write_that_it_came_of():
    steps = [step.what for step in read_back("10 11 22", "10", "11 23").steps]
    assert steps[:2] == ["repeated START, memory (0x50 R)", "address acknowledged"]
    assert steps[2].startswith("byte 1: 0x11 ACK, sent by memory from 0x0010, last written 0x11, ")
    assert steps[3].startswith("byte 2: 0x22 NACK, not 0x23, sent by memory from 0x0011, last written 0x22, ")
    assert len(steps) == 4


def test_a_page_overrun_that_the_memory_noted_is_the_cause():
    found = read_back("1f 11 22", "1f", "11 22")
    noted = "memory: the write at 0x001f went beyond its page's end, 0x001f, on to 0x0000"
    assert found.steps[0].what == noted and found.steps[0].at < 0
    assert str(found.blamed) == noted
    assert found.steps[-1].what == "byte 2: 0xFF NACK, not 0x22, sent by memory from 0x0020"


def test_the_word_that_an_overrun_went_round_to_is_told_as_written():
    found = read_back("1f 11 22", "00", "ff ff")
    assert "byte 1: 0x22 ACK, not 0xFF, sent by memory from 0x0000, last written 0x22" in "\n".join(
        s.what for s in found.steps
    )
    assert str(found.blamed).startswith("memory: the write at 0x001f")


def test_a_note_about_words_that_are_not_read_is_told_and_not_blamed():
    found = read_back("1f 11 22", "40", "11 22")
    assert found.steps[0].what.startswith("memory: the write at 0x001f") and found.blamed is None


def test_where_a_memory_is_read_without_a_word_address_before_the_bytes_are_told_without_it():
    """A read goes on behind the one before; its word is not known, since no write to the same address tells it."""
    asked = [{**REQUEST, "write": "10", "count": 2}, {"address": 0x50, "count": 1, "expect": "33"}]
    steps = chain("wrong bytes", ["50 W 00 10 Sr 50 R 2", "50 R 1"], asked).steps
    assert steps[-1].what == "byte 1: 0xFF NACK, not 0x33, sent by memory"


def test_a_page_begins_at_a_multiple_of_its_length():
    """Pages of 32 bytes: 0x50 lies in the one from 0x40 on."""
    steps = [step.what for step in read_back("50 11 22", "50", "11 23").steps]
    assert steps[2].startswith("byte 1: 0x11 ACK, sent by memory from 0x0050, last written 0x11, ")


def test_a_low_phase_that_rounding_makes_longer_by_a_tick_is_not_held():
    case = load(TIMING / "eeprom_log.toml", ["duration=20 ms", "unit.dsp.ppm=40"])
    steps = steps_of(run_and_explain(case)["round complete"])
    assert len(steps) > 5 and not [step for step in steps if "SCL held" in step]

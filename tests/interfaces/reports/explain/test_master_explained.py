"""Explanations with a unit as master: a device that holds SCL is named, and polls of a busy device are one line."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.interfaces.reports.explain.chain import Chain, text
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import Case
from tests.interfaces.reports.explain.made import run_and_explain, steps_of
from tests.scene.runs import TIMING

SCRIPT = ["50 W 00 10 11 22", "50 W", "50 W", "50 W", "50 W 00 10 Sr 50 R 2"]
REQUEST = {"address": 0x50, "pointer": 0, "count": 0}
REQUESTS = [{**REQUEST, "write": "10 11 22"}, {**REQUEST, "write": "10", "count": 2}]


def explanation_of(measure: str, **device: Any) -> str:
    """Return the explanation of one budget of a script of transfers as text."""
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


def test_polls_without_ack_are_one_line():
    shown = explanation_of("round")
    assert shown.count("not acknowledged") == 1
    assert "memory (0x50 W), not acknowledged, 3 times" in shown


# Bytes that the device sends ---------------------------------------------------------


def read_back(written: str, word: str, expect: str) -> Chain:
    """Write two bytes, then read two from a word address of one byte. The bytes read differ from the expected ones."""
    script = [f"50 W 00 {written}", "50 W", "50 W", "50 W", f"50 W 00 {word} Sr 50 R 2"]
    asked = [{**REQUEST, "write": written}, {**REQUEST, "write": word, "count": 2, "expect": expect}]
    return chain("wrong bytes", script, asked)


NOTED = "memory: the write at 0x001f went beyond its page's end, 0x001f, on to 0x0000"
WROTE_11, WROTE_22 = ", last written 0x11, 1000.847 us before", ", last written 0x22, 1000.847 us before"


@pytest.mark.parametrize(
    ("written", "word", "expect", "sent", "notes", "blamed"),
    [
        (
            *("10 11 22", "10", "11 23"),
            [f"0x11 ACK|0x0010{WROTE_11}", f"0x22 NACK, not 0x23|0x0011{WROTE_22}"],
            *([], None),
        ),
        (  # a page begins at a multiple of its length: 0x50 is in the page from 0x40
            *("50 11 22", "50", "11 23"),
            [f"0x11 ACK|0x0050{WROTE_11}", f"0x22 NACK, not 0x23|0x0051{WROTE_22}"],
            *([], None),
        ),
        (
            *("1f 11 22", "1f", "11 22"),
            [f"0x11 ACK|0x001f{WROTE_11}", "0xFF NACK, not 0x22|0x0020"],
            *([NOTED], NOTED),
        ),
        (  # the word to which the write wrapped
            *("1f 11 22", "00", "ff ff"),
            ["0x22 ACK, not 0xFF|0x0000, last written 0x22, 910.847 us before", "0xFF NACK|0x0001"],
            *([NOTED], NOTED),
        ),
        (  # the note is about words that are not read
            *("1f 11 22", "40", "11 22"),
            ["0xFF ACK, not 0x11|0x0040", "0xFF NACK, not 0x22|0x0041"],
            *([NOTED], None),
        ),
    ],
)
def test_bytes_of_a_memory_are_explained_with_their_writes_and_its_note(
    written: str, word: str, expect: str, sent: list[str], notes: list[str], blamed: str | None
):
    found = read_back(written, word, expect)
    message = [f"byte {n}: {byte.replace('|', ', sent by memory from ')}" for n, byte in enumerate(sent, 1)]
    shown = [*notes, "repeated START, memory (0x50 R)", "address acknowledged", *message]
    assert [step.what for step in found.steps] == shown
    assert (found.blamed and str(found.blamed)) == blamed


def test_bytes_read_without_a_word_address_are_explained_without_it():
    """A read continues after the one before. Its word address is unknown, since no write to this address sets it."""
    asked = [{**REQUEST, "write": "10", "count": 2}, {"address": 0x50, "count": 1, "expect": "33"}]
    steps = chain("wrong bytes", ["50 W 00 10 Sr 50 R 2", "50 R 1"], asked).steps
    assert steps[-1].what == "byte 1: 0xFF NACK, not 0x33, sent by memory"


def test_a_low_phase_that_is_a_tick_longer_by_rounding_is_no_hold():
    case = load(TIMING / "eeprom_log.toml", ["duration=20 ms", "unit.dsp.ppm=40"])
    steps = steps_of(run_and_explain(case)["round complete"])
    assert len(steps) > 5 and not [step for step in steps if "SCL held" in step]

"""The responder in each of its styles: reads of any length, writes, 100 and 400 kHz, and times without an answer."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware.python import responder as firmware
from periph_sim import Dsp, Firmware
from periph_sim.scene import unit as unit_module
from tests.profiles import examples
from tests.scene.runs import Ran, run_case
from tests.scene.small import case

STYLES = [("polled", False), ("polled", True), ("interrupt", False), ("interrupt", True)]
RATES = ["100 kHz", "400 kHz"]
data_bytes = st.binary(min_size=1, max_size=40)


class ResponderRuns:
    """Runs of the responder, of which the last one is kept so that a test can read what it received."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        program = Firmware("responder", self._main, firmware.Settings)
        monkeypatch.setattr(unit_module, "load_firmware", lambda name: program)

    def _main(self, dsp: Dsp, chosen: firmware.Settings) -> None:
        self.responder = firmware.Responder(dsp, chosen)
        self.responder.run()

    def ask(self, style: tuple[str, bool], rate: str, requests: list[dict[str, Any]], **chosen: Any) -> Ran:
        """Run one round of `requests`, one after the other."""
        unit = {
            "firmware": "responder",
            "modules": ["I2C-A"],
            "settings": {"style": style[0], "fifo": style[1], **chosen},
        }
        head = {"rate": rate, "first": "1 ms", "period": "80 ms", "rounds": 1, "gap": "50 us"}
        table = case(unit={"dsp": unit}, controller={**head, "request": [{"address": 0x50, **r} for r in requests]})
        return run_case(table, "0.08")

    @property
    def received(self) -> list[bytes]:
        return [bytes(taken) for taken in self.responder.received]


@pytest.fixture(params=STYLES, ids=["polled", "polled FIFO", "interrupt", "interrupt FIFO"])
def style(request: pytest.FixtureRequest) -> tuple[str, bool]:
    return request.param


@pytest.fixture(params=RATES)
def rate(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.mark.parametrize("length", [1, 2, 3, 4, 5, 15, 16, 17, 33])
def test_reads_of_every_length(monkeypatch, style, rate, length: int):
    reply = bytes(range(1, length + 1))
    ran = ResponderRuns(monkeypatch).ask(
        style, rate, [{"count": length}, {"count": length}], replies=(reply, reply[::-1])
    )
    assert ran.read() == [[reply.hex(" "), reply[::-1].hex(" ")]]
    assert ran.result.stuck == [] and ran.result.verdict == "not judged"


@pytest.mark.parametrize("length", [1, 2, 4, 5, 16, 17, 33])
def test_writes_of_every_length(monkeypatch, style, rate, length: int):
    runs = ResponderRuns(monkeypatch)
    sent = bytes(range(0x80, 0x80 + length))
    ran = runs.ask(style, rate, [{"count": 0, "write": sent.hex(" ")}, {"count": 0, "write": "99"}])
    assert runs.received == [sent, b"\x99"]
    assert ran.result.counts["nacked"] == 0


def test_the_filler_follows_the_end_of_the_reply(monkeypatch, style, rate):
    ran = ResponderRuns(monkeypatch).ask(style, rate, [{"count": 20}], replies=("aa bb",), filler=0xEE)
    assert ran.read() == [["aa bb" + " ee" * 18]]


def test_another_address_is_not_answered(monkeypatch, style, rate):
    ran = ResponderRuns(monkeypatch).ask(style, rate, [{"address": 0x51, "count": 1}, {"count": 1}], replies=("5a",))
    assert ran.read() == [["", "5a"]]
    assert ran.result.counts["nacked"] == 1


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("rate", RATES)
def test_any_bytes_in_any_mix_of_reads_and_writes(style, rate):
    patch = pytest.MonkeyPatch()
    runs = ResponderRuns(patch)

    @settings(max_examples=examples(15), deadline=None)
    @given(st.lists(st.tuples(st.booleans(), data_bytes), min_size=1, max_size=5))
    def holds(script: list[tuple[bool, bytes]]) -> None:
        requests = [{"count": len(d)} if read else {"count": 0, "write": d.hex(" ")} for read, d in script]
        replies = [d for read, d in script if read]
        ran = runs.ask(style, rate, requests, replies=tuple(replies))
        (read_back,) = ran.read()
        assert [r for r, (read, _) in zip(read_back, script, strict=True) if read] == [d.hex(" ") for d in replies]
        assert runs.received == [d for read, d in script if not read]
        assert ran.result.counts["nacked"] == 0 and ran.result.counts["stuck"] == 0

    try:
        holds()
    finally:
        patch.undo()


@pytest.mark.parametrize("pointer", [0x00, 0x55, 0xFF])
def test_a_pointer_with_a_repeated_start_and_the_read_after_it(monkeypatch, style, rate, pointer: int):
    runs = ResponderRuns(monkeypatch)
    ran = runs.ask(style, rate, [{"pointer": pointer, "count": 6}] * 3, replies=("10 11 12 13 14 15",))
    assert ran.read() == [["10 11 12 13 14 15"] * 3]
    assert runs.received == [bytes([pointer])] * 3


def test_only_requests_in_the_busy_time_are_not_acknowledged(monkeypatch, style, rate):
    """The responder accepts the write, does not answer for 1 ms, and then sends a byte."""
    write, read = {"count": 0, "write": "00 01"}, {"count": 1}
    runs = ResponderRuns(monkeypatch)
    ran = runs.ask(style, rate, [write, *[read] * 30], busy=("1 ms",), replies=("77",))
    (transfers,) = ran.rounds
    busy_from = transfers[0].stop_at
    per_ms = ran.scene.timebase.per_second // 1000
    assert transfers[0].acked
    answered = [t.acked for t in transfers[1:]]
    assert False in answered and True in answered
    assert answered == sorted(answered)  # not at first, then always
    last_refused = answered.index(True)  # of transfers[1:]: transfers[last_refused] was refused
    assert transfers[last_refused].phases[0].start_at < busy_from + per_ms
    assert transfers[last_refused + 1].stop_at > busy_from + per_ms
    assert runs.received == [b"\x00\x01"]


def test_a_second_write_has_its_own_busy_time(monkeypatch, style):
    write, read = {"count": 0, "write": "00 01"}, {"count": 1}
    ran = ResponderRuns(monkeypatch).ask(
        style, "100 kHz", [write, read, write, read], busy=("0 us", "1 ms"), replies=("77",)
    )
    assert [t.acked for t in ran.rounds[0]] == [True, True, True, False]


def test_a_responder_that_is_asleep_at_the_start_does_not_answer(monkeypatch, style):
    ran = ResponderRuns(monkeypatch).ask(style, "100 kHz", [{"count": 1}] * 30, asleep="3 ms", replies=("77",))
    answered = [t.acked for t in ran.rounds[0]]
    assert not answered[0] and answered[-1] and answered == sorted(answered)

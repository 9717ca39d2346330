"""Characters that are sent to an SCI from outside: their times, and what the SCI receives."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.bus.uart.reader import LineFrame
from periph_sim.core.records import Kind, Record
from periph_sim.firmware import start_sci
from periph_sim.scene.serial.send_schedule import TextTrigger
from tests.scene.serial.programs import Program, receive, receiver, replier, scene, send
from tests.scene.small import unit

BIT = 26_240  # ticks of a bit of the SCI with BRR = 40, 3 GHz
FE, PE = 1 << 15, 1 << 14


def received_words(
    sends: list[dict[str, Any]], duration: str = "3 ms", serial: dict[str, Any] | None = None, **started: int
):
    """Return the words of SCIRXBUF of SCI-B, including error bits."""
    words: list[int] = []
    table = {"send": [{"to": "SCI-B", "at": "100 us", **one} for one in sends], **(serial or {})}
    run = scene(
        {"dsp": receiver("SCI-B", words, **started)}, unit={"dsp": unit("SCI-B")}, serial=table, duration=duration
    )
    run.run()
    return words


def begins(sends: list[dict[str, Any]], duration: str = "3 ms", **serial: Any) -> list[tuple[float, int]]:
    """Return (us of the start bit, byte) of each character that is sent to SCI-A."""
    seen: list[Record] = []
    table = {"send": [{"to": "SCI-A", **one} for one in sends], **serial}
    programs = {"dsp": replier("SCI-A", {b"go": b"OK", b"!go": b"OK"})}
    run = scene(programs, seen, [Kind.FRAME], unit={"dsp": unit("SCI-A")}, serial=table, duration=duration)
    run.run()
    on_rx = [r for r in seen if r.where == "RX"]
    starts = [r.tick / 3000 for r in on_rx if r.what == "begin"]
    return list(zip(starts, [r.value for r in on_rx if r.what in ("end", "error")], strict=True))


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ({"text": "hi\n"}, [*b"hi\n"]),
        ({"bytes": "00 ff 55"}, [0x00, 0xFF, 0x55]),
        ({"text": "é", "encoding": "latin-1"}, [0xE9]),
        ({"text": "é", "encoding": "utf-8"}, [0xC3, 0xA9]),
    ],
)
def test_sent_characters_are_received(content: dict[str, Any], words: list[int]):
    assert received_words([content]) == words


def test_a_file_is_sent_as_it_is(tmp_path, monkeypatch):
    (tmp_path / "boot.bin").write_bytes(b"\x01\x02\x80")
    monkeypatch.chdir(tmp_path)
    assert received_words([{"file": "boot.bin"}]) == [1, 2, 0x80]


def test_each_character_begins_a_gap_after_the_previous_stop_bit():
    """Two characters of 86.8 us each, at 115200 baud:

    100 us |0123456789|  50 us  |0123456789|
    """
    found = begins([{"text": "ab", "at": "100 us", "gap": "50 us"}])
    assert found == [(pytest.approx(100), ord("a")), (pytest.approx(100 + 10 / 0.1152 + 50, abs=0.001), ord("b"))]


def test_a_second_send_waits_for_the_line():
    first, second = begins([{"text": "a", "at": "100 us"}, {"text": "b", "at": "110 us"}])
    assert second[0] == pytest.approx(100 + 10 / 0.1152, abs=0.001) and first[1] == ord("a")


def test_a_period_repeats_a_send():
    found = begins([{"text": "a", "at": "100 us", "period": "500 us", "times": 3}])
    assert [round(at, 3) for at, _ in found] == [100, 600, 1100]
    assert len(begins([{"text": "a", "at": "100 us", "period": "500 us"}], duration="1.9 ms")) == 4


def test_ppm_moves_times_and_rate():
    slow, late = begins([{"text": "ab", "at": "1 ms"}], ppm=-10_000)
    assert slow[0] == pytest.approx(1000 / 0.99, abs=0.001)
    assert late[0] - slow[0] == pytest.approx(10 / 0.1152 / 0.99, abs=0.002)


def test_after_received_text():
    found = begins([{"text": "go", "at": "100 us"}, {"text": "more", "after_text": "OK", "delay": "20 us"}])
    assert bytes(value for _, value in found) == b"gomore"
    assert [value for _, value in begins([{"text": "x", "after_bytes": "4f 4b"}])] == []


def test_after_an_event_once_some_times_or_each_time():
    def with_times(**times: Any) -> bytes:
        pings = {"text": "go", "at": "100 us", "period": "600 us", "times": 3}
        event = {"text": "!", "after": "frame TX 0x4b end", **times}  # the K of OK
        return bytes(value for _, value in begins([pings, event]))

    assert with_times() == b"go!gogo"
    assert with_times(times=2) == b"go!go!go"
    assert with_times(times="all") == b"go!go!go!"


def test_an_access_is_an_event_at_its_own_tick():
    seen: list[Record] = []
    table = {"send": [{"to": "dsp.SCI-A", "text": "x", "after": "access W SCI-A.SCICTL1"}]}
    run = scene({"dsp": receiver("SCI-A", [])}, seen, unit={"dsp": unit("SCI-A")}, serial=table, duration="1 ms")
    run.run()
    written = next(r.tick for r in seen if r.kind is Kind.ACCESS and r.what == "W SCI-A.SCICTL1")
    assert next(r.tick for r in seen if r.kind is Kind.EDGE and r.where == "RX") == written


def test_a_send_whose_event_never_happened_is_noted():
    table = {"send": [{"to": "dsp.SCI-A", "text": "x", "name": "late", "after": "frame TX 0x21 end"}]}
    result = scene({"dsp": receiver("SCI-A", [])}, unit={"dsp": unit("SCI-A")}, serial=table, duration="1 ms").run()
    assert result.notes[-1] == "serial: send 'late' never went out: no event matched 'frame TX 0x21 end'"
    assert result.sci_bytes == 0


def test_a_send_that_waited_for_a_busy_line_is_noted_and_not_counted():
    """The line is busy with long, |0|1|2|3|4|..., when next becomes due, during the character 1."""
    sends = [{"name": "long", "text": "0123456789"}, {"name": "next", "text": "x"}]
    table = {"send": [{"to": "dsp.SCI-A", "at": f"{at} us", **one} for at, one in zip((0, 100), sends, strict=True)]}
    result = scene({"dsp": receiver("SCI-A", [])}, unit={"dsp": unit("SCI-A")}, serial=table, duration="400 us").run()
    assert result.notes[-1] == (
        "serial: send 'next' never went out: "
        "it was due at 0.000100 s, but its line is busy until 0.000868 s with send 'long'"
    )
    assert result.sci_bytes == 4  # of 86.8 us each; the fifth is under way


# Errors on a wire ----------------------------------------------------------------


def test_wrong_parity_and_a_missing_stop_bit():
    even = {"parity": "even", "bits": 8}
    assert received_words([{"text": "abc", "wrong_parity": [1]}], serial=even, sciccr=0x67) == [97, PE | 98, 99]
    assert received_words([{"text": "abc", "missing_stop": [1]}]) == [97, FE | 98, 99]


def test_characters_with_errors_are_counted_in_the_result():
    """Three of five characters have errors. With RXENA = 0 none is received, so none counts. XRS keeps the counts."""
    sends = [
        {"text": "abc", "missing_stop": [1], "wrong_parity": [1, 2]},
        {"text": "de", "at": "2 ms", "wrong_parity": [0]},
    ]
    table = {"send": [{"to": "SCI-B", "at": "100 us", **one} for one in sends], "parity": "even"}

    def errors(program: Program, **more: Any) -> dict[str, int]:
        run = scene({"dsp": program}, unit={"dsp": unit("SCI-B")}, serial=table, duration="3 ms", **more).run()
        assert run.reception() == [text for text in run.reception(zero=True) if not text.startswith("0 ")]
        return run.sci_errors

    assert errors(receiver("SCI-B", [], sciccr=0x67)) == {"framing error": 1, "parity error": 3}
    reset = {"kind": "reset", "unit": "dsp", "at": "1 ms"}  # before the second send
    assert errors(receiver("SCI-B", [], sciccr=0x67), fault=[reset]) == {"framing error": 1, "parity error": 2}
    assert errors(lambda dsp: None) == {"framing error": 0, "parity error": 0}
    assert scene({"dsp": lambda dsp: None}, unit={"dsp": unit("I2C-A")}).run().sci_errors == {}


@pytest.mark.parametrize(("baud", "noted"), [(120_500, True), (120_000, False), (109_000, False), (108_000, True)])
def test_a_rate_that_differs_by_more_than_5_percent_from_that_of_the_sci_is_a_note(baud: int, noted: bool):
    """BRR = 40 gives 114 329 baud."""
    table = {"send": [{"to": "SCI-A", "text": "a", "at": "100 us", "baud": baud}]}
    result = scene({"dsp": receiver("SCI-A", [])}, unit={"dsp": unit("SCI-A")}, serial=table, duration="1 ms").run()
    text = f"dsp SCI-A: characters on RX come at {baud} baud, but SCIHBAUD, SCILBAUD and LSPCLK give 114329; "
    assert [note.startswith(text) for note in result.notes] == [True] * noted


def test_a_break_sets_brkdt():
    status: list[int] = []

    def main(dsp):
        sci = start_sci(dsp, "SCI-A")
        dsp.spin(lambda: sci.SCIRXST.BRKDT == 1)
        status.append(sci.SCIRXST.all)

    table = {"send": [{"to": "SCI-A", "break": "300 us", "at": "100 us"}]}
    scene({"dsp": main}, unit={"dsp": unit("SCI-A")}, serial=table, duration="1 ms").run()
    assert len(status) == 1 and status[0] & 0x20


def test_a_send_has_the_rate_and_the_format_of_its_own_keys():
    assert received_words([{"text": "UU", "baud": 57_600}]) != [*b"UU"]
    assert received_words([{"bytes": "00", "baud": 57_600}])[0] & FE
    assert received_words([{"text": "a", "parity": "odd"}], sciccr=0x67)[0] == PE | 97  # the SCI has even parity
    assert received_words([{"text": "a", "bits": 7}], sciccr=0x06) == [97]


def test_an_a_sets_the_rate_by_autobaud():
    found: list[int] = []

    def main(dsp):
        sci = start_sci(dsp, "SCI-A", brr=1)
        sci.SCIFFCT.all = 0x2000  # CDC
        dsp.spin(lambda: sci.SCIFFCT.ABD == 1)
        found.append(sci.SCIHBAUD.all << 8 | sci.SCILBAUD.all)

    table = {"baud": 9600, "send": [{"to": "SCI-A", "text": "A", "at": "100 us"}]}
    scene({"dsp": main}, unit={"dsp": unit("SCI-A")}, serial=table, duration="3 ms").run()
    assert found == [pytest.approx(37_500_000 / 8 / 9600 - 1, abs=1)]


@pytest.mark.parametrize(("mode", "sciccr"), [("address-bit", 0x0F), ("idle-line", 0x07)])
def test_a_sleeping_receiver_wakes_at_an_address(mode: str, sciccr: int):
    """Only the block to 0x21 is received completely: the firmware wakes at its own address and sleeps at others."""
    words: list[int] = []

    def main(dsp):
        sci = start_sci(dsp, "SCI-A", sciccr=sciccr)
        sci.SCICTL1.SLEEP = 1
        while True:
            dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0)
            word = sci.SCIRXBUF.all
            words.append(word)
            if sci.SCICTL1.SLEEP == 1:
                if word == 0x21:
                    sci.SCICTL1.SLEEP = 0
            elif word == 3:
                sci.SCICTL1.SLEEP = 1

    blocks = [{"to": "SCI-A", "at": "100 us", "address": n, "bytes": "01 02 03"} for n in (0x20, 0x21, 0x22)]
    table = {"multiprocessor": mode, "send": blocks}
    scene({"dsp": main}, unit={"dsp": unit("SCI-A")}, serial=table, duration="3 ms").run()
    assert words == [0x20, 0x21, 1, 2, 3, 0x22]


def test_both_directions_of_an_sci_are_independent():
    words: list[int] = []

    def main(dsp):
        start_sci(dsp, "SCI-C")
        send(dsp, "SCI-C", bytes(16))
        receive(dsp, "SCI-C", words)

    table = {"send": [{"to": "SCI-C", "at": "100 us", "bytes": "10 20 30"}]}
    scene({"dsp": main}, unit={"dsp": unit("SCI-C")}, serial=table, duration="2 ms").run()
    assert words == [0x10, 0x20, 0x30]


@pytest.mark.parametrize(
    ("wanted", "line", "marks"),
    [
        (b"OK", "xOKxOK", "  ^  ^"),
        (b"OK", "OOKK", "  ^ "),
        (b"aba", "ababab", "  ^   "),  # the second one overlaps the first
        (b"aa", "aaaaa", " ^ ^ "),
        (b"a", "aba", "^ ^"),
        (b"OK", "O?K.OK", "     ^"),  # a wrong character in the text
    ],
)
def test_a_text_trigger_fires_at_the_last_character(wanted: bytes, line: str, marks: str):
    """Characters end at ticks 100, 200, 300 ...; a ? is a character with an error."""
    came: list[int] = []
    trigger = TextTrigger(wanted, came.append)
    for number, character in enumerate(line, 1):
        trigger.character(LineFrame(100 * number - 90, 100 * number, ord(character), character != "?", 0))
    assert came == [100 * number for number, mark in enumerate(marks, 1) if mark == "^"]

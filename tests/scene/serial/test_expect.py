"""Expected replies that are in time, late, wrong, incomplete or never requested: their verdicts and messages."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim import BadCase, Verdict
from periph_sim.core.records import Kind, Record
from periph_sim.firmware import start_sci
from periph_sim.interfaces.commands.result_text import legend
from tests.scene.serial.programs import replier, scene, send, sender
from tests.scene.small import unit

CHARACTER = 10 / 0.1152  # us at 115200 baud


def judged(
    replies: dict[bytes, bytes],
    sends: list[dict[str, Any]],
    *expects: dict[str, Any],
    duration: str = "4 ms",
    delay: int = 0,
    seen: list[Record] | None = None,
    **more: Any,
) -> list[Verdict]:
    """Return the verdicts on firmware that sends these replies. delay: cycles before each reply."""
    table = {
        "send": [{"to": "SCI-A", "name": "ask", "at": "100 us", **one} for one in sends],
        "expect": [{"name": "told", "from": "SCI-A", "after_send": "ask", "within": "1 ms", **one} for one in expects],
    }
    run = scene(
        {"dsp": replier("SCI-A", replies, delay)},
        seen,
        unit={"dsp": unit("SCI-A")},
        serial=table,
        duration=duration,
        **more,
    )
    return run.run().budgets


ASK = [{"text": "ask\n"}]


def test_the_time_of_a_reply_is_that_on_the_wires():
    seen: list[Record] = []
    (verdict,) = judged({b"ask\n": b"OK"}, ASK, {"text": "OK"}, seen=seen)
    frames = [r for r in seen if r.kind is Kind.FRAME and r.what == "end"]
    asked = max(r.tick for r in frames if r.where == "RX")
    told = max(r.tick for r in frames if r.where == "TX")
    assert (verdict.verdict, verdict.measure, verdict.count, verdict.limit) == ("pass", "reply:told", 1, 1000)
    assert verdict.worst == pytest.approx((told - asked) / 3000, abs=1)  # its reader has the nominal rate, the SCI BRR


def test_a_late_reply_fails_with_its_time():
    (verdict,) = judged({b"ask\n": b"OK"}, ASK, {"text": "OK", "within": "1 ms"}, delay=150_000)
    assert verdict.verdict == "fail" and 1000 < verdict.worst == pytest.approx(1000 + 2 * CHARACTER, abs=10)


@pytest.mark.parametrize(
    ("replies", "message"),
    [
        (
            {b"ask\n": b"ER"},
            r"'OK' was expected from SCI-A, but 'ER' came, whose first wrong character ended at 0.0005",
        ),
        ({b"ask\n": b"O"}, "'OK' was expected from SCI-A, but only 'O' came by 0.001447 s"),
        ({}, "'OK' was expected from SCI-A, but nothing came by 0.001447 s"),
        ({b"ask\n": b"NO WAY"}, "'OK' was expected from SCI-A, but 'NO' came, whose first wrong character ended at"),
    ],
)
def test_a_wrong_or_missing_reply_is_reported_with_what_was_received(replies: dict[bytes, bytes], message: str):
    (verdict,) = judged(replies, ASK, {"text": "OK"})
    assert verdict.verdict == "fail" and message in verdict.found
    assert verdict.worst is None and verdict.margin is None and verdict.until_s is not None
    assert verdict.found in legend([verdict])[0]


def test_wrong_characters_long_after_the_limit_are_not_taken_for_the_reply():
    other = {"text": "x", "at": "2500 us", "name": "other"}
    (verdict,) = judged({b"ask\nx": b"NO"}, [*ASK, other], {"text": "OK", "within": "1 ms"})
    assert verdict.found == "'OK' was expected from SCI-A, but nothing came by 0.001447 s"
    (verdict,) = judged({b"ask\nx": b"OK"}, [*ASK, other], {"text": "OK", "within": "1 ms"})
    assert verdict.verdict == "fail" and verdict.worst > 2000 and not verdict.found  # the right one, but late


def test_characters_after_within_or_for_another_send_are_not_part_of_a_wrong_reply():
    """ask |ER|   within |   other |ER|"""
    for at, within in (("2 ms", "1 ms"), ("600 us", "3 ms")):
        other = {"text": "x", "at": at, "name": "other"}
        both = {"text": "OKAY", "within": within}, {"name": "more", "after_send": "other", "text": "ER"}
        told, more = judged({b"ask\n": b"ER", b"x": b"ER"}, [*ASK, other], *both)
        assert told.found.startswith("'OKAY' was expected from SCI-A, but 'ER' came, whose first wrong")
        assert more.verdict == "pass"


def test_a_wrong_character_after_within_is_not_part_of_an_incomplete_reply():
    other = {"text": "x", "at": "2500 us", "name": "other"}
    (verdict,) = judged({b"ask\n": b"O", b"x": b"NK"}, [*ASK, other], {"text": "OK", "within": "1 ms"})
    assert verdict.found == "'OK' was expected from SCI-A, but only 'O' came by 0.001447 s"


def test_a_text_that_takes_longer_than_within_is_refused():
    with pytest.raises(BadCase, match=r"10 characters take 10\.4167 ms at 9600 baud, so no reply can") as told:
        judged({}, ASK, {"text": "0123456789", "within": "9 ms", "baud": 9600})
    assert "within" in str(told.value)
    long = {"text": "0123456789", "period": "5 ms"}  # an echo can begin during the send
    (verdict,) = judged({}, [long], {"text": "0123456789", "within": "400 us"})
    assert verdict.verdict == "fail"
    kept = r"so no reply can keep this, not even one that begins with send 'ask', which takes 0\.347222 ms; give it"
    with pytest.raises(BadCase, match=kept):
        judged({}, [{"text": "0123"}], {"text": "0123456789", "within": "400 us"})


def test_bytes_are_shown_as_bytes_and_bad_ones_marked():
    (verdict,) = judged({b"ask\n": b"\x15"}, ASK, {"bytes": "06"})
    assert "06 was expected from SCI-A, but 15 came" in verdict.found
    (verdict,) = judged({b"ask\n": b"\x07"}, ASK, {"bytes": "07", "parity": "even", "bits": 7})
    assert "07 was expected from SCI-A, but 07! came" in verdict.found


def test_characters_before_the_reply_are_wrong_without_anywhere():
    echo = {b"ask\n": b"ask\nOK"}
    assert judged(echo, ASK, {"text": "OK"})[0].verdict == "fail"
    assert judged(echo, ASK, {"text": "OK", "anywhere": True})[0].verdict == "pass"
    (verdict,) = judged(echo, ASK, {"text": "NO", "anywhere": True})
    assert verdict.found == "'NO' was expected from SCI-A, but 'OK' came last"


def test_characters_count_from_the_begin_of_the_send_and_time_from_its_end():
    """An echo, character by character, begins before the send ends."""
    (verdict,) = judged({b"a": b"a", b"b": b"b"}, [{"text": "ab"}], {"text": "ab"})
    assert verdict.verdict == "pass" and verdict.worst == pytest.approx(CHARACTER, abs=8)


def test_each_repetition_of_a_send_needs_its_reply():
    asks = [{"text": "ask\n", "period": "1 ms", "times": 3}]
    (verdict,) = judged({b"ask\n": b"OK"}, asks, {"text": "OK"})
    assert (verdict.verdict, verdict.count, verdict.occasions) == ("pass", 3, 3)
    slow = [{"text": "ask\n", "period": "2 ms", "times": 3}]
    (verdict,) = judged({b"ask\n": b"OK"}, slow, {"text": "OK", "within": "500 us"}, delay=90_000, duration="7 ms")
    assert (verdict.verdict, verdict.count) == ("fail", 3) and verdict.worst > 600
    gone = {b"ask\n": b"OK"}, asks, {"text": "OK", "within": "500 us"}
    (verdict,) = judged(*gone, delay=120_000)
    assert verdict.verdict == "fail" and "nothing came" in verdict.found  # before the next request


def test_one_wrong_reply_of_three_fails():
    asks = [{"text": "1", "period": "500 us", "times": 3}]
    (verdict,) = judged({b"1": b"A"}, asks, {"text": "A"})
    assert (verdict.verdict, verdict.count) == ("pass", 3)

    def main(dsp):
        sci = start_sci(dsp, "SCI-A")
        for reply in (b"A", b"B", b"A"):
            dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0)
            assert sci.SCIRXBUF.all == ord("1")
            send(dsp, "SCI-A", reply)

    table = {
        "send": [{"to": "SCI-A", "name": "ask", "at": "100 us", **asks[0]}],
        "expect": [{"name": "told", "from": "SCI-A", "after_send": "ask", "within": "1 ms", "text": "A"}],
    }
    (verdict,) = scene({"dsp": main}, unit={"dsp": unit("SCI-A")}, serial=table, duration="4 ms").run().budgets
    assert (verdict.verdict, verdict.count, verdict.occasions) == ("fail", 2, 3)
    assert verdict.found.startswith("'A' was expected from SCI-A, but 'B' came") and verdict.margin > 0
    assert legend([verdict])[0] == f"told: {verdict.found}"


def test_a_reply_may_follow_an_event_or_a_time():
    at_once = replier("SCI-A", {b"x": b"y"})
    booted = {"name": "booted", "from": "SCI-A", "text": "up", "at": "0 s", "within": "1 ms"}

    def main(dsp):
        start_sci(dsp, "SCI-A")
        send(dsp, "SCI-A", b"up")
        at_once(dsp)

    event = {"name": "after", "from": "SCI-A", "text": "y", "after": "frame RX 0x78 end", "within": "1 ms"}
    table = {"send": [{"to": "SCI-A", "text": "x", "at": "1 ms"}], "expect": [booted, event]}
    run = scene({"dsp": main}, unit={"dsp": unit("SCI-A")}, serial=table, duration="4 ms")
    assert [(v.name, v.verdict, v.count) for v in run.run().budgets] == [("booted", "pass", 1), ("after", "pass", 1)]


def test_a_reply_that_was_never_requested_is_not_judged_with_the_reason():
    never = [{"text": "x", "after": "frame TX 0x21 end", "at": None}]
    (verdict,) = judged({}, never, {"text": "OK"})
    assert verdict.verdict == "not judged"
    assert verdict.found == "send 'ask' never went out: no event matched 'frame TX 0x21 end'"
    (verdict,) = judged({}, ASK, {"text": "OK", "after_send": None, "after": "frame TX 0x21 end"})
    assert (verdict.verdict, verdict.found) == ("not judged", "no event matched 'frame TX 0x21 end'")
    (verdict,) = judged({}, [{"text": "x", "at": "9 ms"}], {"text": "OK"})
    assert verdict.found == "send 'ask' never went out: its time is after the end of the run"


def test_a_run_that_ends_before_the_limit_judges_nothing():
    (verdict,) = judged({}, ASK, {"text": "OK", "within": "5 ms"})
    assert verdict.verdict == "not judged"
    assert verdict.found == "the run ended before the reply from SCI-A had to be there; let it last longer"
    (verdict,) = judged({b"ask\n": b"OK"}, [{"text": "ask\n", "period": "1900 us"}], {"text": "OK"}, duration="2.4 ms")
    assert (verdict.verdict, verdict.count) == ("pass", 1)  # the run ends before the second reply is due


def test_a_budget_can_set_further_limits_of_a_reply():
    median = {"name": "median", "measure": "reply:told", "p50": "200 us", "max": "900 us"}
    verdicts = judged({b"ask\n": b"OK"}, ASK, {"text": "OK"}, budget=[median])
    assert [(v.name, v.verdict) for v in verdicts] == [("median", "pass"), ("told", "pass")]


def test_a_wrong_baud_rate_of_the_firmware_is_found():
    """The outside party has its own rate, so firmware with another rate cannot pass."""
    table = {
        "send": [{"to": "SCI-A", "name": "ask", "at": "100 us", "text": "U"}],
        "expect": [{"name": "told", "from": "SCI-A", "after_send": "ask", "within": "1 ms", "text": "U"}],
    }
    run = scene({"dsp": replier("SCI-A", {b"U": b"U"}, brr=81)}, unit={"dsp": unit("SCI-A")}, serial=table)
    assert [v.verdict for v in run.run().budgets] == ["fail"]


def test_a_character_that_began_before_the_request_is_not_part_of_the_reply():
    table = {"expect": [{"name": "told", "from": "SCI-A", "at": "60 us", "text": "b", "within": "1 ms"}]}
    run = scene({"dsp": sender("SCI-A", b"ab")}, unit={"dsp": unit("SCI-A")}, serial=table, duration="2 ms")
    assert [(v.verdict, v.count) for v in run.run().budgets] == [("pass", 1)]


def test_frames_of_address_bit_mode_are_read_with_their_address_bit():
    budget = [{"name": "two", "measure": "count of frame TX end", "exactly": 2}]
    budget += [{"name": "second", "measure": "count of frame TX 0x32", "exactly": 1}]
    program = sender("SCI-A", b"12", sciccr=0x0F)
    result = scene({"dsp": program}, unit={"dsp": unit("SCI-A")}, budget=budget, duration="1 ms").run()
    assert [v.verdict for v in result.budgets] == ["pass", "pass"]

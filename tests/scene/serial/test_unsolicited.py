"""Unsolicited characters: forbidden replies after a send, and characters of the whole run that belong to no reply."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim import Dsp, Result
from periph_sim.core.records import Kind, Record
from periph_sim.firmware import start_sci
from periph_sim.interfaces.commands.result_text import legend
from tests.scene.serial.programs import replier, scene, send
from tests.scene.small import unit

GOOD = {"name": "good", "text": "ask\n", "at": "100 us"}
BAD = {"name": "bad CRC", "text": "asc\n", "at": "2 ms", "expect": "nothing", "within": "1 ms"}
TOLD = {"name": "told", "from": "dsp.SCI-A", "after_send": "good", "text": "OK", "within": "1 ms"}
ALL = {"name": "unasked", "measure": "unsolicited replies", "max": 0}


def ran(
    replies: dict[bytes, bytes],
    *sends: dict[str, Any],
    expects: tuple[dict[str, Any], ...] = (TOLD,),
    duration: str = "4 ms",
    seen: list[Record] | None = None,
    delay: int = 0,
    **more: Any,
) -> Result:
    """Run a scene whose firmware sends these replies. delay: cycles before each reply."""
    table = {"send": [{"to": "SCI-A", **one} for one in sends], "expect": list(expects)}
    program = replier("SCI-A", replies, delay)
    return scene({"dsp": program}, seen, unit={"dsp": unit("SCI-A")}, serial=table, duration=duration, **more).run()


def test_a_frame_that_is_ignored_as_expected_passes():
    result = ran({b"ask\n": b"OK"}, GOOD, BAD)
    silent, told = result.budgets
    assert (silent.name, silent.measure, silent.word, silent.count) == ("bad CRC", "silence:bad CRC", "seen", 1)
    assert (told.word, result.verdict, result.notes) == ("seen", "pass", [])


def test_an_answer_to_a_frame_that_must_be_ignored_fails_with_its_time_and_bytes():
    seen: list[Record] = []
    result = ran({b"ask\n": b"OK", b"asc\n": b"OK"}, GOOD, BAD, seen=seen)
    silent, told = result.budgets
    assert (silent.word, silent.worst, told.word, result.verdict) == ("broken", 2, "seen", "fail")
    sent = [r.tick for r in seen if r.kind is Kind.FRAME and r.where == "TX" and r.what == "begin"]
    assert silent.at_s == pytest.approx(sent[2] / 3e9, abs=1e-7)
    assert silent.until_s == pytest.approx((sent[3] + 10 / 0.1152 * 3000) / 3e9, abs=1e-6)
    assert legend([silent])[0] == (
        f"bad CRC: 2 characters is over its limit of 0 characters, at {silent.at_s:.6f} s (nothing was expected from "
        f"dsp.SCI-A after send 'bad CRC', but 'OK' came, which ended at {silent.until_s:.6f} s)"
    )


def test_a_run_that_ends_before_the_silence_is_over_judges_nothing():
    (silent, _) = ran({b"ask\n": b"OK"}, GOOD, BAD, duration="3 ms").budgets
    assert silent.verdict == "not judged"
    assert silent.found == "the run ended before the silence after send 'bad CRC' was over; let it last longer"


def test_a_send_that_never_went_out_is_not_judged_with_the_reason():
    silent, told = ran({b"ask\n": b"OK"}, GOOD, {**BAD, "at": "9 ms"}).budgets
    assert (silent.verdict, told.word) == ("not judged", "seen")
    assert silent.found == "send 'bad CRC' never went out: its time is after the end of the run"


def test_the_answer_to_the_next_send_is_not_forbidden():
    """The time `within` extends past the next request, whose answer is expected."""
    result = ran({b"asc\nask\n": b"OK"}, {**BAD, "at": "100 us", "within": "3 ms"}, {**GOOD, "at": "1 ms"})
    assert [verdict.word for verdict in result.budgets] == ["seen", "seen"]


def test_a_late_expected_reply_does_not_break_the_silence_after_another_send():
    """The reply to `good` begins after `bad CRC` does, and belongs to the expect that waits for it."""
    result = ran({b"ask\n": b"OK"}, GOOD, {**BAD, "at": "500 us", "text": "x"})
    assert [verdict.word for verdict in result.budgets] == ["seen", "seen"]


def test_a_character_after_within_or_before_the_send_is_not_forbidden_but_unsolicited():
    answered = {b"asc\n": b"OK"}
    assert [v.word for v in ran(answered, BAD, expects=(), budget=[ALL]).budgets] == ["broken", "broken"]
    late = ran(answered, {**BAD, "within": "50 us"}, expects=(), budget=[ALL], delay=15_000)
    assert [v.word for v in late.budgets] == ["broken", "seen"]
    early = ran({b"ask\n": b"O"}, GOOD, {**BAD, "at": "500 us"}, expects=(), budget=[ALL])
    assert [v.word for v in early.budgets] == ["broken", "seen"]


def test_a_character_that_is_under_way_when_other_data_is_sent_is_forbidden():
    later = {"name": "later", "text": "x", "at": "1400 us"}  # the answer begins at 1348 us
    (silent,) = ran({b"asc\n": b"O"}, {**BAD, "at": "1 ms", "within": "3 ms"}, later, expects=()).budgets
    assert (silent.word, silent.worst) == ("broken", 1)
    assert legend([silent])[0].startswith("bad CRC: 1 character is over its limit of 0 characters, at 0.001348 s (")
    again = {**BAD, "at": "1 ms", "within": "3 ms", "period": "400 us", "times": 2}
    (silent,) = ran({b"asc\n": b"O"}, again, expects=(), duration="6 ms").budgets
    assert (silent.word, silent.worst, silent.count) == ("broken", 2, 2)


def test_other_data_or_another_expected_reply_ends_the_silence():
    later = {"name": "later", "text": "x", "at": "2.5 ms"}
    (silent,) = ran({b"asc\nx": b"OK"}, BAD, later, expects=()).budgets
    assert silent.word == "seen"
    heartbeat = {"name": "told", "from": "SCI-A", "at": "1 ms", "text": "OK", "within": "1 ms"}
    for at in ("1 ms", "200 us"):  # after the end of the send, and during it
        expects = ({**heartbeat, "at": at, "within": "2 ms"},)
        result = ran({b"asc\n": b"OK!"}, {**BAD, "at": "100 us", "within": "3 ms"}, expects=expects, delay=150_000)
        assert [v.word for v in result.budgets] == ["seen", "seen"]


def test_unsolicited_characters_give_a_note_or_with_a_budget_a_verdict():
    sends = (GOOD, {**GOOD, "name": "again", "at": "2 ms"})
    result = ran({b"ask\n": b"OK\r"}, *sends)
    (note,) = result.notes
    assert result.verdict == "pass" and note.startswith(
        "serial: nothing was expected from dsp.SCI-A, but '\\r' came, which ended at 0.000"
    )
    assert note.endswith("(4 characters in all); a budget on 'unsolicited replies' judges them")
    judged = ran({b"ask\n": b"OK\r"}, *sends, budget=[ALL])
    assert (judged.verdict, judged.budgets[0].worst, judged.notes) == ("fail", 4, [])


def test_the_note_omits_characters_that_the_verdict_of_a_send_reports():
    result = ran({b"ask\n": b"OK\r", b"asc\n": b"NO"}, GOOD, BAD)
    (note,) = result.notes
    assert result.budgets[0].worst == 2 and "but '\\r' came" in note and "(1 character in all)" in note


def test_a_verdict_on_one_sci_does_not_hide_the_note_on_another():
    def main(dsp: Dsp) -> None:
        start_sci(dsp, "SCI-A")
        bad = start_sci(dsp, "SCI-B")
        dsp.spin(lambda: bad.SCIFFRX.RXFFST == 4)
        send(dsp, "SCI-A", b"!")
        send(dsp, "SCI-B", b"xy")

    modules = {"dsp": unit("SCI-A", "SCI-B")}
    table = {"send": [{**GOOD, "to": "SCI-A"}, {**BAD, "to": "SCI-B"}], "expect": [TOLD]}
    result = scene({"dsp": main}, unit=modules, serial=table, duration="4 ms").run()
    assert result.budgets[0].worst == 2
    assert [note for note in result.notes if "from dsp.SCI-A, but '!' came" in note and "(1 character in all)" in note]


@pytest.mark.parametrize(
    ("limit", "word"),
    [
        ({"max": 2}, "seen"),
        ({"max": 1}, "broken"),
        ({"exactly": 2}, "seen"),
        ({"min": 1}, "seen"),
        ({"min": 3}, "broken"),
    ],
)
def test_the_number_of_unsolicited_characters_is_compared_with_each_limit(limit: dict[str, int], word: str):
    budget = {"name": "unasked", "measure": "unsolicited replies", **limit}
    (unasked,) = ran({b"ask\n": b"OK"}, GOOD, expects=(), budget=[budget]).budgets
    assert (unasked.word, unasked.worst) == (word, 2) and "but 'OK' came" in unasked.found


def test_without_an_expected_reply_every_character_is_unsolicited():
    (unasked,) = ran({b"ask\n": b"OK"}, GOOD, expects=(), budget=[ALL]).budgets
    assert (unasked.word, unasked.worst) == ("broken", 2)
    assert ran({b"ask\n": b"OK"}, GOOD, expects=()).notes == []


def test_replies_in_two_formats_make_no_note_as_each_is_unreadable_in_the_other():
    def main(dsp: Dsp) -> None:
        sci = start_sci(dsp, "SCI-A")
        for rate in (40, 81):
            sci.SCILBAUD.all = rate
            dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0)
            _ = sci.SCIRXBUF.all
            send(dsp, "SCI-A", b"OK")
            dsp.spin(lambda: sci.SCICTL2.TXEMPTY == 1)

    sends = [{"name": name, "to": "SCI-A", "text": "?"} for name in ("fast", "slow")]
    expects = [{"from": "SCI-A", "after_send": name, "text": "OK", "within": "1 ms"} for name in ("fast", "slow")]
    table = {
        "send": [{**sends[0], "at": "1 ms"}, {**sends[1], "at": "2 ms", "baud": 57600}],
        "expect": [{**expects[0], "name": "first"}, {**expects[1], "name": "second", "baud": 57600}],
    }
    result = scene({"dsp": main}, unit={"dsp": unit("SCI-A")}, serial=table, duration="4 ms").run()
    assert result.verdict == "pass" and not [note for note in result.notes if note.startswith("serial")]


def test_a_character_with_an_error_is_marked():
    """Characters are read in the format of the expected reply, so the stop bit of K is read as a wrong parity bit."""
    expects = ({**TOLD, "text": "O", "parity": "even"},)
    silent, told = ran({b"ask\n": b"O", b"asc\n": b"K"}, GOOD, BAD, expects=expects).budgets
    assert (silent.word, told.word) == ("broken", "seen") and "but 4b! came" in silent.found

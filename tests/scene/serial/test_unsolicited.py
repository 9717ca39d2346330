"""Answers that nothing asked for: silence after a send, and characters of the whole run that belong to no reply."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.interfaces.commands.result_text import legend
from periph_sim.scene.result import Result
from tests.scene.serial.programs import answers, scene, unit
from tests.scene.serial.test_expect import answers_late

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
    """delay: cycles before each reply."""
    table = {"send": [{"to": "SCI-A", **one} for one in sends], "expect": list(expects)}
    program = answers_late(replies, delay) if delay else answers("SCI-A", replies)
    return scene({"dsp": program}, seen, unit={"dsp": unit("SCI-A")}, serial=table, duration=duration, **more).run()


def test_a_frame_that_is_rightly_ignored_is_silence():
    result = ran({b"ask\n": b"OK"}, GOOD, BAD)
    silent, told = result.budgets
    assert (silent.name, silent.measure, silent.word, silent.count) == ("bad CRC", "silence:bad CRC", "seen", 1)
    assert (told.word, result.verdict, result.notes) == ("seen", "pass", [])


def test_an_answer_to_it_is_broken_with_its_time_and_its_bytes():
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
    """within reaches over the next request, whose answer is expected."""
    result = ran({b"asc\nask\n": b"OK"}, {**BAD, "at": "100 us", "within": "3 ms"}, {**GOOD, "at": "1 ms"})
    assert [verdict.word for verdict in result.budgets] == ["seen", "seen"]


def test_an_expected_reply_that_comes_late_after_it_is_no_answer_to_it():
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


def test_other_data_or_another_expected_reply_ends_the_silence():
    later = {"name": "later", "text": "x", "at": "2.5 ms"}
    (silent,) = ran({b"asc\nx": b"OK"}, BAD, later, expects=()).budgets
    assert silent.word == "seen"
    heartbeat = {"name": "told", "from": "SCI-A", "at": "1 ms", "text": "OK", "within": "1 ms"}
    result = ran({b"asc\n": b"OK!"}, {**BAD, "at": "100 us", "within": "3 ms"}, expects=(heartbeat,), delay=150_000)
    assert [v.word for v in result.budgets] == ["seen", "seen"]


def test_what_no_reply_claims_is_a_note_and_with_a_budget_a_verdict():
    sends = (GOOD, {**GOOD, "name": "again", "at": "2 ms"})
    result = ran({b"ask\n": b"OK\r"}, *sends)
    (note,) = result.notes
    assert result.verdict == "pass" and note.startswith(
        "serial: nothing was expected from dsp.SCI-A, but '\\r' came, which ended at 0.000"
    )
    assert note.endswith("(4 characters in all); a budget on 'unsolicited replies' judges them")
    judged = ran({b"ask\n": b"OK\r"}, *sends, budget=[ALL])
    assert (judged.verdict, judged.budgets[0].worst, judged.notes) == ("fail", 4, [])


def test_without_an_expected_reply_every_character_is_unsolicited():
    (unasked,) = ran({b"ask\n": b"OK"}, GOOD, expects=(), budget=[ALL]).budgets
    assert (unasked.word, unasked.worst) == ("broken", 2)
    assert ran({b"ask\n": b"OK"}, GOOD, expects=()).notes == []


def test_a_character_with_an_error_is_marked():
    """Read with the format of the reply that is expected from the same SCI: the stop bit of K is a wrong parity bit."""
    expects = ({**TOLD, "text": "O", "parity": "even"},)
    silent, told = ran({b"ask\n": b"O", b"asc\n": b"K"}, GOOD, BAD, expects=expects).budgets
    assert (silent.word, told.word) == ("broken", "seen") and "but 4b! came" in silent.found

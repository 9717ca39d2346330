"""Causes of wrong replies: the picture reaches from the request to the wrong part, and the writes are explained.

RX  |-a-|                 the request, at 100 us, 115200 baud
CPU      w(E) w(R)        OK is expected
TX       |-E-|-R-|
"""

from __future__ import annotations

import pytest

from periph_sim.core.records import Kind
from periph_sim.firmware import sci_fifo_receiver, start_pie, start_sci
from periph_sim.interfaces.reports.explain.characters import characters
from periph_sim.interfaces.reports.explain.explain import Explained
from periph_sim.interfaces.reports.explain.picture import text_picture
from periph_sim.interfaces.reports.html.failure import failure
from periph_sim.processor.dsp import Dsp
from tests.interfaces.reports.explain.made import run_and_explain, steps_of
from tests.scene.serial.programs import Program, replier, sender
from tests.scene.small import case, unit


def explained(
    replies: dict[bytes, bytes], ask: str = "a", text: str = "OK", duration: str = "2 ms", bits: int = 8
) -> Explained:
    expect = {"name": "reply", "from": "SCI-A", "after_send": "ask", "within": "1 ms", "text": text}
    return explain_reply(replier("SCI-A", replies, sciccr=bits - 1), ask, expect, duration, bits)


def explain_reply(
    program: Program, ask: str, expect: dict[str, str], duration: str, bits: int = 8, modules: tuple[str, ...] = ()
) -> Explained:
    """Return the explanation of the verdict on the reply to a request at 100 us."""
    send = {"to": "SCI-A", "name": "ask", "at": "100 us", "text": ask}
    table = {"bits": bits, "send": [send], "expect": [expect]}
    small = case(unit={"dsp": unit("SCI-A", *modules)}, serial=table, duration=duration)
    return run_and_explain(small, program)["reply"]


def test_a_wrong_reply_is_shown_to_its_end_with_the_writes_of_wrong_characters():
    shown = explained({b"a": b"ER"})
    window, steps = shown.window, steps_of(shown)
    ends = [r.tick for r in window.records if (r.kind, r.where, r.what) == (Kind.FRAME, "TX", "end")]
    assert window.end == pytest.approx(ends[1], abs=30_000)  # 10 us, because the reader uses the nominal rate
    assert steps[0] == "RX: the last character of what asks for it"
    assert [step for step in steps if "SCITXBUF" in step] == [
        "dsp: SCITXBUF written, 0x45: character 0 of the reply, not 0x4f",
        "dsp: SCITXBUF written, 0x52: character 1 of the reply, not 0x4b",
    ]
    assert {step.place.function for step in shown.chain.steps if step.place and "SCITXBUF" in step.what} == {"send"}
    sent = [one for one in characters(window) if one.wire == "TX"]
    assert [one.text for one in sent] == ["0x45 not 0x4F", "0x52 not 0x4B"]
    assert "".join(text for _, _, text in sent[0].bits) == "S10100010T"
    lanes = {line.split(" ")[0] for line in text_picture(window, 100)}
    assert {"RX", "TX"} <= lanes
    message = failure(shown.chain.verdict, False, shown.chain, None, window.timebase.per_second)
    assert message is not None and message.what.startswith("'OK' was expected from SCI-A, but 'ER' came")
    assert "SCITXBUF written, 0x45" in message.why and "programs.py" in message.place


R_NOT_K = "dsp: SCITXBUF written, 0x52: character 1 of the reply, not 0x4b"


@pytest.mark.parametrize(
    ("replies", "ask", "text", "bits", "wrong"),
    [
        # RX |a|b|c|   TX  |a|b|X|: the first two begin before the time of the reply.
        (
            *({b"a": b"a", b"b": b"b", b"c": b"X"}, "abc", "abc", 8),
            ["dsp: SCITXBUF written, 0x58: character 2 of the reply, not 0x63"],
        ),
        # The window keeps 5 ms before the occurrence, and the 60 characters sent take 5.2 ms.
        (
            *({b"x" * 60: b"ER"}, "x" * 60, "OK", 8),
            ["dsp: SCITXBUF written, 0x45: character 0 of the reply, not 0x4f", R_NOT_K],
        ),
        # The begin of the request is not kept, and a write followed it, so the first write of the reply is unknown.
        ({b"x" * 30: b"E"}, "x" * 60, "OK", 8, []),
        ({b"a": b"\xcfR"}, "a", "OK", 7, [R_NOT_K]),  # a bit that is not sent is not wrong
    ],
)
def test_wrong_characters_are_explained_if_the_first_of_the_reply_is_known(
    replies: dict[bytes, bytes], ask: str, text: str, bits: int, wrong: list[str]
):
    steps = steps_of(explained(replies, ask, text, "8 ms", bits))
    assert "RX: the last character of what asks for it" in steps
    assert [step for step in steps if "of the reply" in step] == wrong


def test_a_reply_cut_short_is_shown_up_to_its_limit():
    shown = explained({b"a": b"O"})
    assert (
        shown.chain.verdict.broken and shown.window.end - shown.window.begin >= shown.window.timebase.per_second // 1000
    )
    assert not [step for step in steps_of(shown) if "character" in step and "SCITXBUF" in step]


def test_a_reply_expected_at_a_time_has_no_request():
    booted = {"name": "reply", "from": "SCI-A", "at": "1 us", "within": "1 ms", "text": "OK"}
    small = case(unit={"dsp": unit("SCI-A")}, serial={"expect": [booted]}, duration="2 ms")
    steps = steps_of(run_and_explain(small, sender("SCI-A", b"OR"))["reply"])
    assert [step for step in steps if "character" in step] == [R_NOT_K]


def test_unsolicited_characters_are_explained_with_their_writes():
    """RX |a|      |b|           TX of SCI-A |O|K| |E|R|, where only OK was expected; SCI-B sends nothing."""
    sends = [{"to": "SCI-A", "name": name, "at": at, "text": name} for name, at in (("a", "100 us"), ("b", "1 ms"))]
    table = {
        "send": [{"to": "SCI-B", "name": "c", "at": "1 ms", "text": "c"}, *sends],
        "expect": [{"name": "reply", "from": "SCI-A", "after_send": "a", "within": "500 us", "text": "OK"}],
    }
    budget = {"name": "unasked", "measure": "unsolicited replies", "max": 0}
    small = case(unit={"dsp": unit("SCI-A", "SCI-B")}, serial=table, budget=[budget], duration="2 ms")
    shown = run_and_explain(small, replier("SCI-A", {b"a": b"OK", b"b": b"ER"}))["unasked"]
    steps = [step for step in shown.chain.steps if "SCITXBUF" in step.what]
    assert [step.what for step in steps] == [
        "dsp: SCITXBUF written, 0x45: unsolicited",
        "dsp: SCITXBUF written, 0x52: unsolicited",
    ]
    assert {step.place.function for step in steps if step.place} == {"send"}
    assert shown.chain.blame is not None and shown.chain.blame.place == steps[0].place


# Missing replies --------------------------------------------------------------------


OK = {"name": "reply", "from": "dsp.SCI-A", "after_send": "ask", "within": "1 ms", "text": "OK"}


def missing_reply(program: Program, *modules: str, text: str = "ab") -> Explained:
    """Return the explanation of the missing reply OK to a request `text` at 100 us."""
    return explain_reply(program, text, OK, "3 ms", modules=modules)


def test_a_missing_reply_is_explained_by_the_reads_and_the_place_of_the_firmware():
    steps = steps_of(missing_reply(replier("SCI-A", {b"x": b"OK"})))
    assert steps[:3] == [
        "no interrupt is entered from here on",
        "RX: the last character of what asks for it",
        "SCIRXBUF read, 2 times since the request began: 0x61 0x62",
    ]
    assert steps[-1].startswith("dsp: wait for SCI-A.SCIFFRX.RXFFST, begun 9")
    long = steps_of(missing_reply(replier("SCI-A", {b"x": b"OK"}), text="a" * 20))
    assert f"SCIRXBUF read, 20 times since the request began: {'0x61 ' * 15}0x61, ..." in long


@pytest.mark.parametrize(("at", "until"), [("3 ms", 1000), ("500 us", 313.2)])
def test_a_missing_reply_is_explained_up_to_its_limit_or_the_next_send(at: str, until: float):
    """RX |a|    limit 1 ms     |b|      or       |a|  |b|   limit"""
    sends = [{"to": "SCI-A", "name": text, "at": when, "text": text} for text, when in (("a", "100 us"), ("b", at))]
    table = {"send": sends, "expect": [{**OK, "after_send": "a"}]}
    small = case(unit={"dsp": unit("SCI-A")}, serial=table, duration="6 ms")
    shown = run_and_explain(small, replier("SCI-A", {b"b": b"ER"}))["reply"]
    assert shown.chain.us(shown.chain.length) == pytest.approx(until, abs=1)
    assert shown.chain.us(shown.chain.steps[-1].at) == pytest.approx(until, abs=1)
    assert [step for step in steps_of(shown) if "SCIRXBUF" in step] == [
        "SCIRXBUF read, 1 time since the request began: 0x61"
    ]
    assert "SCITXBUF" not in " ".join(steps_of(shown))


def test_a_missing_reply_of_firmware_that_reads_nothing_is_explained():
    def main(dsp: Dsp) -> None:
        start_sci(dsp, "SCI-A")
        with dsp.span("elsewhere"):
            dsp.compute(10**6)

    steps = steps_of(missing_reply(main))
    assert "no interrupt is entered and SCIRXBUF is not read from here on" in steps
    assert steps[-1].startswith("dsp: span elsewhere, begun 1")


def test_interrupts_before_a_missing_reply_are_counted():
    def main(dsp: Dsp) -> None:
        sci, pie = dsp.module("SCI-A"), dsp.module("PIE")

        def received() -> None:
            assert sci.SCIRXBUF.all
            sci.SCIFFRX.RXFFINTCLR = 1
            pie.PIEACK.all = 0x100

        sci_fifo_receiver(dsp, brr=40, level=1)
        start_pie(dsp, {"SCIRXINTA": received})
        dsp.eint()
        with dsp.span("forever"):
            dsp.compute(10**6)

    steps = steps_of(missing_reply(main, text="abc"))
    assert "SCIRXINTA entered, 3 times since the request began" in steps
    assert "SCIRXBUF read, 3 times since the request began: 0x61 0x62 0x63" in steps
    assert "no interrupt" not in " ".join(steps)


def test_a_request_cut_by_a_timeout_is_explained_from_its_first_part():
    """RX |x| |a|  pause 1 ms  |b|     A frame ends after 500 us without a character; X is the reply to x."""

    def main(dsp: Dsp) -> None:
        sci = start_sci(dsp, "SCI-A")
        while True:
            dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0)
            frame = bytes([sci.SCIRXBUF.all & 0xFF])
            while dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0, timeout=75_000):
                frame += bytes([sci.SCIRXBUF.all & 0xFF])
            if frame in (b"x", b"ab"):
                sci.SCITXBUF.all = ord("X")

    times = {"x": "100 us", "a": "2 ms", "b": "3 ms", "c": "12 ms"}
    sends = [{"to": "SCI-A", "name": text, "at": at, "text": text} for text, at in times.items()]
    table = {"send": sends, "expect": [{**OK, "after_send": "b", "within": "5 ms"}]}
    shown = run_and_explain(case(unit={"dsp": unit("SCI-A")}, serial=table, duration="20 ms"), main)["reply"]
    steps = steps_of(shown)
    assert "SCIRXBUF read, 2 times since the request began: 0x61 0x62" in steps
    gave_up = [
        step for step in shown.chain.steps if step.what.endswith("wait for SCI-A.SCIFFRX.RXFFST gave up (timeout)")
    ]
    assert [shown.chain.us(step.at) for step in gave_up] == pytest.approx([-1000, 0], abs=10)
    assert [shown.chain.us(step.length or 0) for step in gave_up] == pytest.approx([500, 500], abs=1)
    assert len({(step.at, step.what) for step in shown.chain.steps}) == len(steps)
    (cut, *_) = gave_up
    assert "wait for SCI-A.SCIFFRX.RXFFST gave up (timeout)" in {str(part) for part in shown.chain.parts}
    assert shown.window.drawn.begin <= shown.window.at + cut.at


def test_firmware_that_polls_a_timer_for_ever_is_explained_with_the_timer_and_the_line():
    def main(dsp: Dsp) -> None:
        sci, timer = start_sci(dsp, "SCI-A"), dsp.module("TIMER0")
        dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0)
        assert sci.SCIRXBUF.all
        while timer.TIM.all > 0:
            dsp.compute(100)

    last = missing_reply(main, "TIMER0", text="a").chain.steps[-1]
    assert last.what.startswith("dsp: other code, 0.") and last.what.endswith(" us after TIMER0.TIM read")
    assert last.place is not None and last.place.function == "main"

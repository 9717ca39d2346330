"""Expected replies on hand-made characters: their times, and replies that are missing or wrong."""

from __future__ import annotations

from periph_sim.timing.measures.expectations import Expected, Reply
from tests.timing.events_by_hand import scene_of, summary

WITHIN = 100


def reply_to(drawn: str, end: int, text: str = "OK", anywhere: bool = False) -> Reply:
    """The measure of a reply after a sequence of events, with the run ending at `end`.

    `ask 10-20`: the request begins and ends; `O 30-40`: a character; `else 50`: something else is requested; `sent 50`:
    a send begins.
    """
    expected = Expected(tuple(map(ord, text)), lambda received: "".join(map(chr, received)), "SCI-A", WITHIN, anywhere)
    reply = Reply("reply")
    reply.listen(scene_of(ticks_per_second=1000, on_reply=lambda reply: (expected, lambda: "it was never asked for")))
    for what, at in (event.split() for event in drawn.split(", ") if event):
        begin, _, over = at.partition("-")
        if what == "else":
            reply.others_turn(int(begin))
        elif what == "sent":
            reply.sent(int(begin))
        elif what == "ask":
            reply.window(int(begin))
            reply.due(int(over))
        else:
            reply.character(int(begin), int(over), ord(what), True)
    reply.finish(end)
    return reply


def test_the_time_of_a_reply_is_from_the_end_of_the_request_to_the_end_of_its_last_character():
    reply = reply_to("ask 10-20, O 30-40, K 40-50, ask 200-210, O 215-220, K 220-225", 1000)
    assert summary(reply) == (30, 20, 15, 2) and not reply.refuted
    assert (reply.measured, reply.occasions) == (2, 2)


def test_a_missing_reply_has_no_time_and_is_missing_until_its_limit_or_the_next_send():
    """A reply is due within 100. The run ends at 500, and the last request is at 300.

    ask |10 20|             within 100         |
    """
    reply = reply_to("ask 10-20", 500)
    assert reply.count == 0 and (reply.measured, reply.occasions) == (1, 1)
    missing = "OK was expected from SCI-A, but nothing came by 0.120000 s"
    assert (reply.refuted, reply.refuted_at, reply.refuted_until) == (missing, 20, 120)
    for sends in ("sent 70", "sent 70, sent 90"):
        before = reply_to(f"sent 10, ask 10-20, {sends}", 500)
        assert (before.refuted, before.refuted_at, before.refuted_until) == (missing, 20, 70)
    assert reply_to("ask 10-20, sent 130", 500).refuted_until == 120
    again = reply_to("ask 10-20, ask 300-310, O 320-330, K 330-340", 500)
    assert summary(again) == (30, 310, 30, 1) and again.refuted_at == 20


def test_a_second_request_does_not_end_the_wait_for_a_reply_that_is_still_in_time():
    """The first reply is in time, 80 after its request, although the second request is before it.

    ask |10 20|            within 100         |
                      ask |100 105| OK OK
    """
    reply = reply_to("ask 10-20, ask 100-105, O 106-108, K 108-110, O 110-112, K 112-114", 500)
    assert summary(reply) == (90, 20, 9, 2) and not reply.refuted
    late = reply_to("ask 10-20, ask 130-140, O 150-155, K 155-160", 500)
    assert summary(late) == (20, 140, 20, 1) and late.refuted_at == 20

"""A reply by characters made by hand: how long it took, what is wrong with it, and when that was."""

from __future__ import annotations

from periph_sim.timing.measures.expectations import Expected, Reply
from tests.timing.events_by_hand import came, scene_of

WITHIN = 100


def heard(drawn: str, end: int, text: str = "OK", anywhere: bool = False) -> Reply:
    """`ask 10-20`: what asks for it begins and ends; `O 30-40`: a character; `else 50`: something else is asked for.

    `sent 50`: a send begins.
    """
    expected = Expected(tuple(map(ord, text)), lambda came: "".join(map(chr, came)), "SCI-A", WITHIN, anywhere)
    reply = Reply("told")
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


def test_a_reply_takes_from_the_end_of_what_asks_to_the_end_of_its_last_character():
    reply = heard("ask 10-20, O 30-40, K 40-50, ask 200-210, O 215-220, K 220-225", 1000)
    assert came(reply) == (30, 20, 15, 2) and not reply.refuted
    assert (reply.measured, reply.occasions) == (2, 2)


def test_a_reply_that_never_comes_has_no_time_and_is_missing_up_to_its_limit_or_the_next_send():
    """
    ask |10 20|             within 100         |  the run ends at 500; asked for again at 300
    """
    reply = heard("ask 10-20", 500)
    assert reply.count == 0 and (reply.measured, reply.occasions) == (1, 1)
    missing = "OK was expected from SCI-A, but nothing came by 0.120000 s"
    assert (reply.refuted, reply.refuted_at, reply.refuted_until) == (missing, 20, 120)
    for sends in ("sent 70", "sent 70, sent 90"):
        before = heard(f"sent 10, ask 10-20, {sends}", 500)
        assert (before.refuted, before.refuted_at, before.refuted_until) == (missing, 20, 70)
    assert heard("ask 10-20, sent 130", 500).refuted_until == 120
    again = heard("ask 10-20, ask 300-310, O 320-330, K 330-340", 500)
    assert came(again) == (30, 310, 30, 1) and again.refuted_at == 20


def test_one_that_is_still_in_time_is_waited_for_though_it_is_asked_for_again():
    """
    ask |10 20|            within 100         |
                      ask |100 105| OK OK          the first is 80 old by then, and comes in time
    """
    reply = heard("ask 10-20, ask 100-105, O 106-108, K 108-110, O 110-112, K 112-114", 500)
    assert came(reply) == (90, 20, 9, 2) and not reply.refuted
    late = heard("ask 10-20, ask 130-140, O 150-155, K 155-160", 500)
    assert came(late) == (20, 140, 20, 1) and late.refuted_at == 20

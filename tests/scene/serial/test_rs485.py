"""RS-485 half duplex: the driver's pin, the receiver that is off meanwhile, turnaround, collisions, and cut frames.

ask on the pair |=======|
DE              ________|~~~~~~~~~~~~~|____     too early: the frame under way is cut
TX                       |==|==|==|==|
"""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.firmware import start_pin, start_sci
from periph_sim.records.record_text import happened
from periph_sim.scene.case.model import BadCase
from tests.scene.serial.programs import receive, receiver, replier, scene
from tests.scene.small import unit

PIN = 34
ON = {"on": "dsp.SCI-A", "de": "dsp.GPIO34"}
CHARACTER = 10 / 0.1152  # us


def replies(reply: bytes, waits_for: str = "TXEMPTY", pause: int = 0, received: list[int] | None = None):
    """Return firmware that answers each character with `reply` and then clears DE.

    waits_for: TXEMPTY, the transmitter is empty before DE is cleared, or TXFFST, only its FIFO is.
    pause: cycles from the character to DE. received: takes the words of its receiver.
    """

    def main(dsp):
        start_pin(dsp, PIN)
        sci = start_sci(dsp, "SCI-A")
        while True:
            dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0)
            word = sci.SCIRXBUF.all
            if received is not None:
                received.append(word)
            dsp.compute(pause)
            dsp.set_pin(PIN)
            for byte in reply:
                sci.SCITXBUF.all = byte
            if waits_for == "TXEMPTY":
                dsp.spin(lambda: sci.SCICTL2.TXEMPTY == 1)
            else:
                dsp.spin(lambda: sci.SCIFFTX.TXFFST == 0)
            dsp.clear_pin(PIN)

    return main


def run(program, seen: list[Record] | None = None, transceiver: dict[str, Any] | None = None, **more: Any):
    serial = {
        "send": [{"name": "ask", "to": "dsp.SCI-A", "text": "?", "at": "200 us"}],
        "expect": [{"name": "told", "from": "dsp.SCI-A", "text": "OK", "after_send": "ask", "within": "1 ms"}],
        **more.pop("serial", {}),
    }
    units = {"dsp": unit("SCI-A", "GPIO")}
    tables = {
        "unit": units,
        "transceiver": transceiver if isinstance(transceiver, list) else [{**ON, **(transceiver or {})}],
        "serial": serial,
        "duration": "2 ms",
    }
    return scene({"dsp": program}, seen, **{**tables, **more}).run()


def test_a_reply_comes_over_the_pair_without_a_note():
    words: list[int] = []
    result = run(replies(b"OK", received=words))
    assert [(v.name, v.verdict, v.count) for v in result.budgets] == [("told", "pass", 1)]
    assert words == [ord("?")]  # its receiver is off while it drives
    assert not [note for note in result.notes if "RS485" in note]


def test_a_receiver_that_stays_on_receives_its_own_frames():
    words: list[int] = []
    run(replies(b"", received=words), transceiver={"hears_itself": True})
    assert words == [ord("?")]

    def once(dsp):
        start_pin(dsp, PIN)
        sci = start_sci(dsp, "SCI-A")
        dsp.set_pin(PIN)
        sci.SCITXBUF.all = 0x5A
        dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0)
        words.append(sci.SCIRXBUF.all)

    run(once, transceiver={"hears_itself": True}, serial={"send": [], "expect": []})
    assert words[-1] == 0x5A


@pytest.mark.parametrize(("reply", "came"), [(b"OK", "but 4f f[0-9a-f]!? came|but 4f [0-9a-f]+!? came")])
def test_a_driver_that_goes_off_too_early_cuts_the_last_frame(reply: bytes, came: str):
    """The usual mistake: DE is cleared as the FIFO is empty, but the last character is still in the shift register."""
    seen: list[Record] = []
    result = run(replies(reply, waits_for="TXFFST"), seen)
    (verdict,) = result.budgets
    assert verdict.verdict == "fail" and "'OK' was expected from dsp.SCI-A, but" in verdict.found
    note = "RS485: dsp.GPIO34 switches the driver of dsp.SCI-A off before its frame is over, first at "
    assert [line.startswith(note) for line in result.notes] == [True]
    (cut,) = [r for r in seen if r.kind is Kind.FRAME and r.what == "cut"]
    off = next(
        r.tick for r in seen if r.where == "dsp.GPIO34" and r.kind is Kind.EDGE and not r.value and r.tick > 10**6
    )
    assert cut.tick == off
    assert happened(cut) == "RS485: a frame is cut by its driver, transceiver of dsp.SCI-A"


def test_only_the_stop_bit_is_lost():
    """The bias of the pair has the level of the stop bit, so the reply is right; the cut is still reported."""

    def main(dsp):
        start_pin(dsp, PIN)
        sci = start_sci(dsp, "SCI-A")
        dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0)
        dsp.set_pin(PIN)
        sci.SCITXBUF.all = ord("O")
        sci.SCITXBUF.all = ord("K")
        dsp.spin(lambda: sci.SCIFFTX.TXFFST == 0)
        dsp.compute(int(9.6 * 1312))  # cycles of a bit at BRR = 40
        dsp.clear_pin(PIN)

    count = {"name": "cut", "measure": "count of frame RS485 cut", "max": 0}
    result = run(main, budget=[count])
    verdicts = {v.name: (v.verdict, v.worst) for v in result.budgets}
    assert verdicts["told"][0] == "pass" and verdicts["cut"] == ("fail", 1)


def test_a_reply_before_the_sender_releases_the_pair_is_a_collision():
    """The outside party drives the pair for 300 us after its last stop bit; the reply begins at once."""
    count = {"name": "collisions", "measure": "count of frame RS485 collision", "exactly": 1}
    asks = {"turnaround": "300 us"}
    seen: list[Record] = []
    result = run(replies(b"OK"), seen, serial=asks, budget=[count])
    assert result.budgets[0].verdict == "pass"
    note = "RS485: serial and transceiver of dsp.SCI-A drive at once, first at "
    assert [line.startswith(note) for line in result.notes] == [True]
    late = run(replies(b"OK", pause=60_000), serial=asks, budget=[{**count, "exactly": 0}])
    assert [v.verdict for v in late.budgets] == ["pass", "pass"] and late.notes == []


def test_turnaround_is_measured_from_the_pair_to_the_pin():
    turn = {"name": "turn", "measure": "from frame RS485 0x3f end to edge dsp.GPIO34 rise, next", "max": "1 ms"}
    shorter, longer = (run(replies(b"OK", pause=cycles), budget=[turn]).budgets[0].worst for cycles in (0, 1500))
    assert longer - shorter == pytest.approx(10.0, abs=0.01)  # 1500 cycles


def test_de_has_the_level_of_its_pull_while_it_is_not_driven():
    seen: list[Record] = []
    run(receiver("SCI-A", []), seen)
    edges = [(r.tick, r.value) for r in seen if r.kind is Kind.EDGE and r.where == "dsp.GPIO34"]
    assert edges == [(0, 0)]
    up: list[Record] = []
    result = run(receiver("SCI-A", []), up, transceiver={"pull": "up"})
    assert not [r for r in up if r.kind is Kind.EDGE and r.where == "dsp.GPIO34"]
    assert "RS485: transceiver of dsp.SCI-A and serial drive at once, first at" in result.notes[-1]


def test_a_frame_with_the_driver_off_is_not_sent_and_is_noted():
    result = run(replier("SCI-A", {b"?": b"OK"}))
    assert result.budgets[0].found.endswith("but nothing came by 0.001287 s")
    assert "RS485: dsp.SCI-A sends a frame while dsp.GPIO34 holds its driver off, first at " in result.notes[-1]
    assert result.notes[-1].endswith("(2 times)")


def test_two_units_share_a_pair():
    """One unit asks over SCI-A, the other answers over SCI-B; each switches its own transceiver."""
    words: list[int] = []

    def asks(dsp):
        start_pin(dsp, PIN)
        sci = start_sci(dsp, "SCI-A")
        dsp.compute(30_000)
        dsp.set_pin(PIN)
        sci.SCITXBUF.all = ord("?")
        dsp.spin(lambda: sci.SCICTL2.TXEMPTY == 1)
        dsp.clear_pin(PIN)
        receive(dsp, "SCI-A", words)

    def replies_once(dsp):
        start_pin(dsp, 5)
        sci = start_sci(dsp, "SCI-B")
        dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0)
        dsp.compute(1000)
        dsp.set_pin(5)
        sci.SCITXBUF.all = ord("!")
        dsp.spin(lambda: sci.SCICTL2.TXEMPTY == 1)
        dsp.clear_pin(5)

    pair = [{"on": "left.SCI-A", "de": "left.GPIO34"}, {"on": "right.SCI-B", "de": "right.GPIO5"}]
    units = {"left": unit("SCI-A", "GPIO"), "right": unit("SCI-B", "GPIO")}
    result = scene({"left": asks, "right": replies_once}, unit=units, transceiver=pair, duration="2 ms").run()
    assert words == [ord("!")] and not [note for note in result.notes if "RS485" in note]


def test_the_driver_pin_may_be_given_by_its_name_in_the_unit():
    named = {"dsp": unit("SCI-A", "GPIO", pins={"DE": PIN})}
    result = run(replies(b"OK"), unit=named, transceiver={"de": "DE"})
    assert result.verdict == "pass" and not [note for note in result.notes if "RS485" in note]


@pytest.mark.parametrize(
    ("table", "more", "message"),
    [
        ({"on": "dsp.SCI-B"}, {}, "transceiver.0.on: unit dsp has no SCI-B; add it to its modules"),
        ({"de": "dsp.GPIO99"}, {}, "transceiver.0.de: dsp.GPIO99: the pins are GPIO0 to GPIO87"),
        ({"de": "other.GPIO1"}, {}, "transceiver.0.de: there is no unit 'other'; it has dsp"),
        ({"de": "DE"}, {}, "transceiver.0.de: there is no pin 'DE'; it has dsp.SCI-A.RX, dsp.SCI-A.TX, dsp.GPIO0"),
        (
            {"de": "DE"},
            {
                "unit": {
                    "dsp": unit("SCI-A", "GPIO", pins={"DE": PIN}),
                    "other": unit("GPIO", pins={"DE": PIN}),
                }
            },
            "transceiver.0.de: DE is no pin of one unit; give a GPIO of the unit, for instance dsp.GPIO34",
        ),
        ({"pair": "RX"}, {}, "transceiver.0.pair: RX is a wire already; give the pair another name"),
        (
            {},
            {"host": {}},
            "transceiver.0.on: the host drives the RX of dsp.SCI-A already, which the transceiver would drive, too",
        ),
        (
            {},
            {"unit": {"dsp": unit("SCI-A")}},
            "transceiver.0.de: unit dsp has no GPIO, which would drive dsp.GPIO34; add it to its modules",
        ),
        (
            {},
            {"transceiver": [ON, ON]},
            "transceiver.1.on: dsp.SCI-A has a transceiver already; an SCI has one",
        ),
        (
            {},
            {"budget": [{"name": "b", "measure": "count of frame TX cut", "max": 0}]},
            "budget.b.measure: 'frame TX cut': only on an RS-485 pair is a frame cut; write frame RS485 cut",
        ),
    ],
)
def test_an_invalid_transceiver_is_refused(table: dict[str, str], more: dict[str, Any], message: str):
    with pytest.raises(BadCase) as caught:
        tables = {"transceiver": [{**ON, **table}], **more}
        run(replies(b"OK"), **tables)
    assert str(caught.value) == f"case small: {message}"

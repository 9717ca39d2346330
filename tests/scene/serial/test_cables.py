"""Two units joined by cables: bytes, events of the lines between them, and pins."""

from __future__ import annotations

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.firmware import start_sci
from periph_sim.scene.case.model import BadCase
from tests.scene.serial.programs import receive, replier, scene, sender
from tests.scene.small import sentence_of, unit

BOTH_WAYS = [{"from": "left.SCI-A.TX", "to": "right.SCI-B.RX"}, {"from": "right.SCI-B.TX", "to": "left.SCI-A.RX"}]
UNITS = {"left": unit("SCI-A", "GPIO"), "right": unit("SCI-B")}


def asks_and_receives(words: list[int]):
    """Return firmware that sends "ask" over SCI-A and stores what it receives."""

    def main(dsp):
        sender("SCI-A", b"ask")(dsp)
        receive(dsp, "SCI-A", words)

    return main


def test_one_unit_replies_to_the_other():
    words: list[int] = []
    programs = {"left": asks_and_receives(words), "right": replier("SCI-B", {b"ask": b"told"})}
    run = scene(programs, unit=UNITS, cable=BOTH_WAYS, duration="2 ms")
    run.run()
    assert bytes(words) == b"told"
    assert set(run.wires) == {"left.SCI-A.TX", "right.SCI-B.TX"}


def test_budgets_and_records_name_the_lines():
    words: list[int] = []
    programs = {"left": asks_and_receives(words), "right": replier("SCI-B", {b"ask": b"told"})}
    turn = {"name": "turn", "measure": "from last frame left.SCI-A.TX end of burst to frame right.SCI-B.TX, next"}
    asked = {"name": "asked", "measure": "count of frame left.SCI-A.TX 0x6b", "exactly": 1}
    lost = {"name": "lost", "measure": "overruns", "max": 0}
    seen: list[Record] = []
    budgets = [{**turn, "max": "1 us"}, asked, lost]
    run = scene(programs, seen, [Kind.FRAME], unit=UNITS, cable=BOTH_WAYS, duration="2 ms", budget=budgets)
    verdicts = {verdict.name: verdict for verdict in run.run().budgets}
    frames = [(r.where, chr(r.value)) for r in seen if r.what == "end"]
    assert frames == [("left.SCI-A.TX", x) for x in "ask"] + [("right.SCI-B.TX", x) for x in "told"]
    end = next(r.tick for r in seen if r.what == "end" and r.value == ord("k"))
    begin = next(r.tick for r in seen if r.what == "begin" and r.where == "right.SCI-B.TX")
    assert verdicts["turn"].worst == pytest.approx((begin - end) / 3000, abs=0.001)  # us of 3000 ticks
    assert verdicts["asked"].passed
    assert (verdicts["lost"].verdict, verdicts["lost"].measured, verdicts["lost"].occasions) == ("pass", 7, 7)


def test_a_gpio_of_one_unit_is_seen_by_the_other():
    risen: list[int] = []

    def lifts(dsp):
        gpio = dsp.module("GPIO")
        dsp.eallow()
        gpio.GPADIR.GPIO12 = 1
        dsp.edis()
        dsp.compute(1000)
        dsp.set_pin(12)

    def waits(dsp):
        gpio = dsp.module("GPIO")
        dsp.compute(500)
        dsp.spin(lambda: gpio.GPADAT.GPIO13 == 1)
        risen.append(1)

    line = [{"from": "left.GPIO12", "to": "right.GPIO13", "name": "READY"}]
    run = scene({"left": lifts, "right": waits}, unit={"left": unit("GPIO"), "right": unit("GPIO")}, cable=line)
    run.run()
    assert risen == [1] and list(run.wires) == ["READY"]


def test_sci_c_on_its_own_pins_receives_what_sci_b_sends():
    words: list[int] = []
    wires = [{"from": "dsp.SCI-B.TX", "to": "dsp.SCI-C.RX"}]

    def main(dsp):
        start_sci(dsp, "SCI-C")
        sender("SCI-B", b"\x5a")(dsp)
        receive(dsp, "SCI-C", words)

    scene({"dsp": main}, unit={"dsp": unit("SCI-B", "SCI-C", "GPIO")}, cable=wires, duration="1 ms").run()
    assert words == [0x5A]


def test_an_unknown_line_in_a_budget_is_reported():
    budget = [{"name": "b", "measure": "count of frame left.SCI-A.RX", "max": 0}]
    assert "there is no serial line 'left.SCI-A.RX'; did you mean left.SCI-A.TX?" in sentence_of(
        BadCase,
        lambda: scene(
            {"left": sender("SCI-A", b""), "right": sender("SCI-B", b"")}, unit=UNITS, cable=BOTH_WAYS, budget=budget
        ),
    )

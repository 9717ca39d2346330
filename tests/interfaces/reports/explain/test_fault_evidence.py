"""Causes of faults: the write or the missing read that led to a wrong byte, to ones on the bus or to a hang.

The picture of the fault must show this cause.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.firmware import start_i2c
from periph_sim.interfaces.reports.explain.evidence import Evidence, RecordedPhase
from periph_sim.interfaces.reports.explain.explain import Explained
from periph_sim.interfaces.reports.explain.fault_evidence import answering, bytes_sent
from periph_sim.interfaces.reports.explain.findings import FINDINGS, Ends
from periph_sim.interfaces.reports.explain.picture import svg_picture, text_picture
from periph_sim.interfaces.reports.html.protocol import bytes_of
from periph_sim.interfaces.reports.html.protocol import rows as rows_of
from periph_sim.processor.dsp import Dsp
from periph_sim.scene.case.load import load
from periph_sim.traces.capture.capture import Channel
from periph_sim.traces.decode import i2c
from tests.interfaces.reports.explain.made import drawn, run_and_explain, steps_of
from tests.records.scenes import line_of
from tests.scene.runs import TIMING
from tests.scene.small import case

READ = {"address": 0x50, "count": 2, "expect": "01 02"}
WRITE = {"address": 0x50, "write": "01 02"}


def explained(
    serve: Callable[[Any, Dsp], None],
    measure: str,
    request: dict[str, Any],
    start: bool = True,
    limit: str | int = 0,
    duration: str = "8 ms",
    **controller: Any,
) -> Explained:
    """Explain the only budget of a scene with `serve` as a slave at 0x50. `start` sets up the module before."""

    def main(dsp: Dsp) -> None:
        i2c = dsp.module("I2C-A")
        if start:
            start_i2c(dsp, own_address=0x50)
            i2c.I2CMDR.IRS = 1
        serve(i2c, dsp)
        dsp.compute(1_000_000)

    head = {"first": "1 ms", "period": "3 ms", "request": [request], **controller}
    made = case(
        duration,
        unit={"dsp": {"firmware": "slave", "modules": ["I2C-A"]}},
        controller=head,
        budget=[{"name": "b", "measure": measure, "max": limit}],
    )
    return run_and_explain(made, main)["b"]


def place_of(one: Explained, words: str) -> str:
    """Return the place in the firmware of the first step that contains these words."""
    place = next(step.place for step in one.chain.steps if words in step.what)
    return f"{place.function}:{place.line}" if place else ""


# NACK ------------------------------------------------------------------------------


def other_address(i2c: Any, dsp: Dsp) -> None:
    dsp.compute(30_000)
    i2c.I2COAR.all = 0x51


def address_too_late(i2c: Any, dsp: Dsp) -> None:
    """The address phase takes 95 us and begins 1 ms after main; I2COAR is written 1.1 ms after main."""
    i2c.I2COAR.all = 0x51
    dsp.compute(165_000)
    i2c.I2COAR.all = 0x50


def reset_before(i2c: Any, dsp: Dsp) -> None:
    dsp.compute(100_000)
    i2c.I2CMDR.IRS = 0


@pytest.mark.parametrize("measure", ["nacked", "nacked rounds", "count of bus NACK", "count of bus NACK address"])
@pytest.mark.parametrize(
    ("serve", "words", "below", "written_us"),
    [
        (other_address, "I2COAR = 0x51 written,", 2, -800),
        (address_too_late, "I2COAR = 0x50 written, 5.", 4, 100),
        (reset_before, "I2CMDR.IRS cleared, so the module releases SDA", 2, -333),
    ],
)
def test_an_address_nack_is_traced_to_the_write_that_caused_it(
    serve: Callable[[Any, Dsp], None], words: str, below: int, written_us: int, measure: str
):
    """`written_us` is the time from the START of the request to the write."""
    one = explained(serve, measure, READ)
    step = next(step for step in one.chain.steps if words in step.what)
    start = next(step for step in one.chain.steps if step.what.startswith("START, "))
    assert place_of(one, words) == line_of(serve, below)
    assert round(one.chain.us(step.at - start.at)) == pytest.approx(written_us, abs=1)
    assert one.chain.blamed is not None and one.chain.blamed.place == step.place
    assert any(what == "address 0x50 not acknowledged" for what in steps_of(one))


def no_address(i2c: Any, dsp: Dsp) -> None:
    start_i2c(dsp)  # this writes I2COAR = 0
    i2c.I2CMDR.IRS = 1


def no_release(i2c: Any, dsp: Dsp) -> None:
    start_i2c(dsp, own_address=0x50)


def no_clock(i2c: Any, dsp: Dsp) -> None:
    i2c.I2COAR.all = 0x50
    i2c.I2CMDR.IRS = 1


def never_addressed(i2c: Any, dsp: Dsp) -> None:
    dsp.eallow()
    dsp.module("SYS").PCLKCR0.I2CAENCLK = 1
    dsp.edis()
    dsp.compute(10)
    i2c.I2CMDR.IRS = 1


@pytest.mark.parametrize(
    ("serve", "shown"),
    [
        (no_address, "I2COAR = 0x00 written, "),
        (no_release, "I2CMDR.IRS = 0, so the module releases SDA: the firmware has never set it"),
        (no_clock, "PCLKCR0.I2CAENCLK = 0, so the module has no clock: the firmware has never set it"),
        (never_addressed, "I2COAR = 0x00: the firmware has never written it"),
    ],
)
def test_an_address_nack_is_traced_to_the_missing_write(serve: Callable[[Any, Dsp], None], shown: str):
    assert any(what.startswith(shown) for what in steps_of(explained(serve, "nacked", READ, start=False)))


def refuse_byte(i2c: Any, dsp: Dsp) -> None:
    dsp.spin(lambda: i2c.I2CSTR.AAS == 1)
    i2c.I2CMDR.NACKMOD = 1


def reset_in_byte(i2c: Any, dsp: Dsp) -> None:
    dsp.spin(lambda: i2c.I2CSTR.AAS == 1)
    dsp.compute(6000)
    i2c.I2CMDR.IRS = 0


def test_a_nack_to_the_firmware_as_master_is_not_explained_by_its_own_address():
    """The firmware is the master, and no device has the address 0x51."""
    run = case(
        "2 ms",
        unit={"dsp": {"firmware": "master", "modules": ["I2C-A"]}},
        budget=[{"name": "b", "measure": "count of bus NACK", "max": 0}],
    )

    def main(dsp: Dsp) -> None:
        start_i2c(dsp, own_address=0x50)
        i2c = dsp.module("I2C-A")
        i2c.I2CSAR.all = 0x51
        i2c.I2CMDR.all = 0x2E20  # STT, STP, MST, TRX, IRS
        dsp.spin(lambda: i2c.I2CSTR.NACK == 1)

    one = run_and_explain(run, main)["b"]
    assert "address 0x51 not acknowledged" in steps_of(one)
    assert not any("I2COAR" in what or "IRS" in what for what in steps_of(one))


# Bytes and hangs ---------------------------------------------------------------------


def answer_wrongly(i2c: Any, dsp: Dsp) -> None:
    """Answer each read with 1 and 3, where 1 and 2 are expected."""
    i2c.I2CEMDR.BCM = 0
    while True:
        dsp.spin(lambda: i2c.I2CSTR.SDIR == 1)
        for byte in (1, 3):
            i2c.I2CDXR.all = byte
            dsp.spin(lambda: i2c.I2CSTR.XRDY == 1 or i2c.I2CSTR.SCD == 1)
        dsp.spin(lambda: i2c.I2CSTR.SCD == 1)
        i2c.I2CSTR.all = 0x4020


def test_a_wrong_byte_is_explained_by_the_line_that_wrote_it():
    one = explained(answer_wrongly, "wrong bytes", READ)
    (shown,) = [step for step in one.chain.steps if step.what.startswith("byte 2: 0x03")]
    assert "written" in shown.what and shown.place is not None
    assert f"{shown.place.function}:{shown.place.line}" == line_of(answer_wrongly, 6)
    assert {(place, value) for (_, _, place), value in one.window.expected.items()} == {(1, 2)}  # byte 1 is correct


def test_a_byte_written_for_another_transfer_is_explained():
    one = run_and_explain(load(TIMING / "imu_hil_no_sdir.toml", ["duration=12 ms"]))["wrong bytes"]
    assert any(
        what.startswith("byte 1: 0x12 ACK, not 0x11, written to I2CDXR") and what.endswith("for gyroscope (0x68 W)")
        for what in steps_of(one)
    )
    assert one.chain.blamed is not None and one.chain.blamed.place is not None
    boxes = next(line for line in text_picture(one.window, 120) if line.startswith("bytes"))
    assert boxes.count("!") == 6 and " 0x13! " in boxes
    wrong = ["0x12 not 0x11", "0x13 not 0x12", "0x14 not 0x13", "0x15 not 0x14", "0x16 not 0x15", "0x00 not 0x16"]
    assert re.findall(r">(0x\w+ not 0x\w+)</text>", svg_picture(one.window)) == wrong
    labels = [label for _, _, label, *_ in bytes_of(i2c.transfers(one.window.edges), 0, one.window.expected_on_bus)]
    assert [label for label in labels if "not" in label][:6] == wrong
    rows = [row.data for row in rows_of(one.window, lambda at, end: True, 0) if row.bus == "I2C" and row.way == "R"]
    assert [expected for _, _, expected in rows[0]] == ["11", "12", "13", "14", "15", "16"]


def test_the_expected_bytes_of_a_long_read_are_known_at_its_first_wrong_byte():
    def serve(i2c: Any, dsp: Dsp) -> None:
        while True:
            dsp.spin(lambda: i2c.I2CSTR.SDIR == 1 and i2c.I2CSTR.XRDY == 1)
            i2c.I2CDXR.all = 0x12

    slow = {"address": 0x50, "count": 40, "expect": "11" * 40}  # takes 37 ms at 10 kHz
    one = explained(serve, "wrong bytes", slow, duration="80 ms", rate="10 kHz", period="50 ms")
    assert steps_of(one)[2].startswith("byte 1: 0x12 ACK, not 0x11")


def reset_in_read(i2c: Any, dsp: Dsp) -> None:
    dsp.spin(lambda: i2c.I2CSTR.SDIR == 1)
    i2c.I2CDXR.all = 1
    dsp.compute(12_000)
    i2c.I2CMDR.IRS = 0


def read_nothing(i2c: Any, dsp: Dsp) -> None:
    dsp.spin(lambda: i2c.I2CSTR.RRDY == 1)
    assert i2c.I2CDRR.all == 1
    dsp.spin(lambda: i2c.I2CSTR.SCD == 1)


@pytest.mark.parametrize(
    ("serve", "measure", "request_", "words", "below", "shown"),
    [
        (
            *(refuse_byte, "count of bus NACK byte", WRITE),
            *("I2CMDR.NACKMOD set, so the module refuses the next byte, 99.", 2, "byte 1: 0x01 NACK"),
        ),
        (
            *(reset_in_byte, "count of bus NACK byte", WRITE),
            *("I2CMDR.IRS cleared, so the module releases SDA, 59.", 3, "byte 1: 0x01 NACK"),
        ),
        (  # ones on the bus
            *(reset_in_read, "wrong bytes", READ),
            *(
                "I2CMDR.IRS cleared, so the module releases SDA",
                4,
                "byte 2: 0xFF NACK, not 0x02, which was not",
            ),
        ),
        (
            *(read_nothing, "missed rounds", {"address": 0x50, "write": "01 02 03 04"}),
            *("I2CDRR read for the last time", 2, "I2CSTR.RSFULL set: a second byte is in, and I2CDRR is unread"),
        ),
    ],
)
def test_a_nack_a_wrong_byte_and_a_hang_are_traced_to_the_access_that_caused_them(
    serve: Callable[[Any, Dsp], None], measure: str, request_: dict[str, Any], words: str, below: int, shown: str
):
    one = explained(serve, measure, request_)
    assert place_of(one, words) == line_of(serve, below)
    assert any(what.startswith(shown) for what in steps_of(one))
    assert measure == "missed rounds" or str(one.chain.blamed) == words.partition(",")[0]


def trust_old_stop(i2c: Any, dsp: Dsp) -> None:
    """The wait for XRDY or SCD ends because of the SCD of the transfer before."""
    while True:
        dsp.spin(lambda: i2c.I2CSTR.SDIR == 1)
        for byte in (1, 2, 3):
            i2c.I2CDXR.all = byte
            if dsp.spin_either(lambda: i2c.I2CSTR.XRDY == 1, lambda: i2c.I2CSTR.SCD == 1):
                break
        dsp.spin(lambda: i2c.I2CSTR.SCD == 1)
        dsp.spin(lambda: i2c.I2CSTR.BB == 0)
        i2c.I2CSTR.all = 0x4000  # SDIR alone: SCD stays


def test_a_wait_that_an_old_flag_ended_is_explained():
    one = explained(trust_old_stop, "missed rounds", {**READ, "count": 3, "expect": "01 02 03"}, period="2 ms")
    assert [what.partition(",")[0] for what in steps_of(one)] == [
        "0x50 (0x50 R)",
        "I2C-A.I2CSTR.BB set",
        "the firmware sees I2CSTR.SCD",
        "wait for I2C-A.I2CSTR.BB begins",
        "SCL held low by dsp: wait for I2C-A.I2CSTR.BB",
        "a round is due",
        "dsp: wait for I2C-A.I2CSTR.BB",
    ]
    assert steps_of(one)[2] == "the firmware sees I2CSTR.SCD, which rose 1624.900 us before this transfer began"


@pytest.mark.parametrize(
    ("serve", "measure", "request_", "named", "reaches"),
    [
        (address_too_late, "nacked", READ, {"I2COAR"}, False),
        (other_address, "nacked", READ, {"I2COAR"}, False),  # it does not change in the picture
        (refuse_byte, "count of bus NACK byte", WRITE, {"NACKMOD"}, True),
        (read_nothing, "missed rounds", {"address": 0x50, "write": "01 02 03 04"}, {"RSFULL"}, True),
        (answer_wrongly, "wrong bytes", READ, {"I2CDXR"}, True),
        (reset_in_read, "wrong bytes", READ, {"I2CDXR", "IRS"}, True),
    ],
)
def test_the_picture_has_the_lanes_named_in_the_chain_and_contains_near_evidence(
    serve: Callable[[Any, Dsp], None], measure: str, request_: dict[str, Any], named: set[str], reaches: bool
):
    one = explained(serve, measure, request_)
    window = one.window
    ticks = [window.begin + step.at for step in one.chain.steps]
    assert (window.drawn.begin <= min(ticks) and max(ticks) <= window.drawn.end) == reaches
    assert named <= {line.split(" ")[0] for line in text_picture(window, 120)}
    assert all(lane in " ".join(window.chain_texts) for lane in named)


def test_a_byte_is_explained_by_the_last_write_before_its_first_bit():
    """
    I2CDXR   w11          w11              the second write is for the next byte
    SCL     |____|‾‾|_|‾ ... |_  byte
             20  30       40     90
    """
    window = drawn("wait AAS -10 200")
    byte = Record(9, 90, Kind.BUS, "controller", "byte", 0x11 << 1, "", 0)
    writes = [Record(n, at, Kind.ACCESS, "dsp", "W I2C-A.I2CDXR", 0x11, "f:1", 0) for n, at in ((7, 20), (8, 40))]
    channels = (
        Channel("SDA", 0, 1, np.array([85])),
        Channel("SCL", 1, 1, np.array([15, 30, 35, 45, 50])),
    )
    window = replace(window, records=(*window.records, *writes, byte), edges=replace(window.edges, channels=channels))
    phase = RecordedPhase("", 0, 99, 0x50, True, True, 15, "START", (byte,))
    evidence = Evidence(window, case(unit={"dsp": {"firmware": "given", "modules": ["I2C-A"]}}))
    ((_, write, said_of_it),) = bytes_sent(evidence, phase)
    assert write == writes[0] and said_of_it == "byte 1: 0x11 ACK, written to I2CDXR 0.023 us before its end"


@pytest.mark.parametrize(
    ("begin", "shown"),
    [
        (0, ["controller: START: a period of", "then one of"]),
        (-40, ["controller: START: a period of"]),
        (40, ["controller: START: a period of"]),
    ],
)
def test_a_jitter_has_no_period_before_the_first_event_and_none_after_the_last(begin: int, shown: list[str]):
    window = drawn(begin=begin)
    verdict = replace(window.verdict, measure="jitter of bus START")
    starts = tuple(Record(n, 40 * n, Kind.BUS, "controller", "START", 0, "", 0) for n in (-1, 0, 1))
    evidence = Evidence(replace(window, verdict=verdict, records=starts), BOTH)
    steps = [step for find in FINDINGS for step in find(evidence, Ends.of(evidence))[0]]
    assert [step.what for step in steps if step.what in shown] == shown
    assert all(step.length != 0 for step in steps)


def test_a_missing_request_of_a_round_is_explained_by_the_start_in_its_place():
    """Firmware as master requests 0x50 and 0x51; in its second round it omits 0x51."""
    made = case(
        "4 ms",
        unit={
            "dsp": {
                "firmware": "captured_master",
                "modules": ["I2C-A"],
                "settings": {"script": ["50 W", "51 W", "50 W", "50 W", "51 W"], "pauses": ["500 us"] * 5},
            }
        },
        rounds={"period": "1.2 ms", "request": [{"address": 0x50, "count": 0}, {"address": 0x51, "count": 0}]},
        budget=[{"name": "b", "measure": "missed rounds", "max": 0}],
    )
    one = run_and_explain(made)["b"]
    assert (one.chain.verdict.worst, one.chain.verdict.broken) == (1, True)
    assert steps_of(one)[-1] == "0x50 W begins, and the request before it was not made"
    assert steps_of(one)[:-1] == ["0x50 W, not acknowledged"], "these steps are of the period before"


# The unit ---------------------------------------------------------------------------------

UNIT = {"firmware": "given", "modules": ["I2C-A"]}
BOTH = case(unit={"head": UNIT, "dsp": UNIT})


def test_evidence_is_of_the_first_unit_with_activity_or_else_of_the_first_unit():
    assert Evidence(drawn("wait AAS 0 100"), BOTH).unit == "dsp"
    assert Evidence(drawn(), BOTH).unit == "head"
    assert Evidence(drawn("wait AAS 0 100"), BOTH, "head").unit == "head"
    assert Evidence(drawn(), case()).unit == ""


def test_a_read_is_explained_by_the_unit_with_its_address_unless_a_device_has_it():
    wrote = Record(9, 5, Kind.ACCESS, "dsp", "W I2C-A.I2COAR", 0x50, "f:1", 0)
    window = drawn("wait AAS 0 100")
    window = replace(window, records=(*window.records, wrote))
    read = RecordedPhase("", 10, 90, 0x50, True, True, 20, "START", ())
    assert answering(Evidence(window, BOTH, "head"), read).unit == "dsp"
    memory = BOTH.model_copy(update={"device": case(device={"memory": {"model": "24lc64"}}, rounds=None).device})
    assert answering(Evidence(window, memory, "head"), read).unit == "head"


def test_a_memory_has_only_its_own_addresses():
    tables = {"whole": {"model": "24lc16"}, "block": {"model": "24c04", "address": 0x54}, "one": {"model": "24c02"}}
    found = {}
    for name, table in tables.items():
        devices = case(device={name: table}, rounds=None)
        found[name] = sorted(Evidence(drawn(), devices).devices)
    assert found == {"whole": list(range(0x50, 0x58)), "block": [0x54, 0x55], "one": [0x50]}

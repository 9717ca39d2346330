"""The tables of a case at the limits of their keys: the last accepted and the first refused values."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from periph_sim.bus.uart.frame_format import UartFormat
from periph_sim.core.convert import BadTable
from periph_sim.scene.case.device_tables import DeviceFault, DeviceTable, StretchTable
from periph_sim.scene.case.model import Case
from periph_sim.scene.case.serial import ExpectTable, SendTable, SerialTable, in_words
from tests.scene.small import sentence_of

PYTHON, IMAGE, SOURCES = (
    {"modules": [], **one} for one in ({"firmware": "x"}, {"image": "x.out"}, {"sources": ["x.c"]})
)
READ = {"address": 0x10}


def check(kind: Any, table: dict[str, Any], message: str) -> None:
    """Check that the table is accepted, or refused with this part of a message."""
    if message:
        assert message in sentence_of(BadTable, lambda: kind.model_validate(table))
    else:
        kind.model_validate(table)


def unit(table: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"unit": {"dsp": table | more}}


def request(**table: Any) -> dict[str, Any]:
    return {"controller": {"request": [table]}}


def values(**table: Any) -> dict[str, Any]:
    return {"chip": {"it": {"model": "m", "values": table}}}


@pytest.mark.parametrize(
    ("tables", "message"),
    [
        (unit(PYTHON), ""),
        (unit({"modules": []}), "a unit needs a program; give firmware, or image"),
        (unit(PYTHON, image="x.out"), "a unit has one program; give firmware or image, not both"),
        (unit(SOURCES, settings={}), "only Python firmware has settings; sources take [unit.NAME.compile] defines"),
        (unit(IMAGE, memory={"x": 1}), ""),
        (unit(PYTHON, memory={"x": 1}), "memory is of an image's variables; settings are what Python firmware takes"),
        (unit(IMAGE, pll=10), "pll is of Python firmware; an image says that by itself, so leave it out"),
        (unit(IMAGE, code={}), "code is of Python firmware"),
        (unit(PYTHON, boot="entry"), "boot is of an image; Python firmware begins at main, so leave it out"),
        (unit(IMAGE, boot="flash", stub=[{"register": "X", "value": 0xFFFF}]), ""),
        (unit(IMAGE, stub=[{"register": "X", "value": 0x10000}]), "value"),
        (unit(IMAGE, stub=[{"register": "X", "value": -1}]), "value"),
        (unit(PYTHON, pll=1), ""),
        (unit(PYTHON, pll=0), "pll"),
        (unit(PYTHON, pll=11), "pll"),
        (unit(PYTHON, pins={"A": 0, "B": 87}), ""),
        (unit(PYTHON, pins={"A": 88}), "pins"),
        (unit(PYTHON, pins={"A": -1}), "pins"),
        (request(**READ, count=0), ""),
        (request(**READ, count=65535), ""),
        (request(**READ, count=65536), "count"),
        (request(**READ, count=2, expect="00 01"), ""),
        (request(**READ, count=2, expect="00"), "expect has 1 byte, but count is 2"),
        (request(chip="gyroscope"), ""),
        (request(name="r"), "a request needs either chip or address"),
        (request(chip="gyroscope", **READ), "a request needs either chip or address"),
        (request(chip="gyroscope", pointer=1, count=2), "chip says count and pointer already; leave that out or give"),
        ({"controller": {"first": "5 ms", "initialise": "5 ms"}}, ""),
        ({"controller": {"first": "5 ms", "initialise": "5.001 ms"}}, "initialise is longer than first"),
        ({"controller": {"period": "10 us", "rate": "100 kHz"}}, ""),
        ({"controller": {"period": "9 us", "rate": "100 kHz"}}, "period is shorter than a bit of SCL"),
        ({"controller": {"low": "300 ns", "hold": "300 ns"}}, ""),
        ({"controller": {"low": "300 ns", "hold": "301 ns"}}, "hold is 301 ns, longer than SCL is low, 300 ns, so SDA"),
        ({"controller": {"rate": "1 MHz", "hold": "500 ns"}}, ""),
        ({"controller": {"rate": "1 MHz", "hold": "501 ns"}}, "hold is 501 ns, longer than SCL is low, 500 ns"),
        ({"controller": {"period": "10 ms", "jitter": "10 ms"}}, ""),
        ({"controller": {"period": "10 ms", "jitter": "10.001 ms"}}, "jitter is longer than period"),
        ({"controller": {"rounds": 1}}, ""),
        ({"controller": {"rounds": 0}}, "rounds"),
        ({"controller": {}, "rounds": {"period": "1 ms"}}, "[controller] says its rounds already; leave one of them"),
        ({"rounds": {"period": "1 ms", "rounds": 1}}, ""),
        ({"rounds": {"period": "1 ms", "rounds": 0}}, "rounds"),
        ({"host": {"period": "10 ms", "jitter": "10 ms"}}, ""),
        ({"host": {"period": "10 ms", "jitter": "10.001 ms"}}, "jitter is longer than period"),
        ({"host": {"period": "10 us", "baud": 100_000}}, ""),
        ({"host": {"period": "9 us", "baud": 100_000}}, "period is shorter than a bit of the line"),
        ({"host": {"baud": 1, "period": "1 s", "frames": 0, "lose": [[0, 0], [3, 11]], "twice": [0]}}, ""),
        ({"host": {"baud": 10_000_000}}, ""),
        ({"host": {"baud": 10_000_001}}, "baud"),
        ({"host": {"baud": 0}}, "baud"),
        ({"host": {"frames": -1}}, "frames"),
        ({"host": {"lose": [[0, 12]]}}, "lose"),
        ({"host": {"lose": [[0, -1]]}}, "lose"),
        ({"host": {"twice": [-1]}}, "twice"),
        (values(fixed=[1, 2, 3], unit="LSB"), ""),
        (values(), "values need one of fixed, rows and ramp"),
        (values(fixed=[1, 2, 3], rows=[["1 ms", 1, 2, 3]]), "values need one of fixed, rows and ramp"),
        (values(fixed=[1, 2, 3], ramp="angles"), "values need one of fixed, rows and ramp"),
        (values(ramp="angles", first="1 ms", period="2 ms"), ""),
        (values(fixed=[1, 2, 3], first="1 ms"), "first and period belong to ramp; give ramp, or leave them out"),
        (values(rows=[["1 ms", 1, 2, 3]], period="1 ms"), "first and period belong to ramp"),
        ({"outside": {"wires": ["RX"]}}, ""),
        ({"outside": {"wires": []}}, "wires"),
        ({"breaks": ["b"], "budget": [{"name": "b", "measure": "round", "max": "1 s"}]}, ""),
        ({"breaks": ["c"], "budget": [{"name": "b", "measure": "round", "max": "1 s"}]}, "there is no budget 'c'"),
    ],
)
def test_a_table_at_its_limits(tables: dict[str, Any], message: str):
    tree = {"name": "x", "duration": "1 s", **tables}
    check(Case, tree, message)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"bytes": [0]}, ""),
        ({"bytes": [-1]}, "bytes"),
        ({"phases": [1]}, ""),
        ({"phases": [0]}, "phases"),
        ({"share": "0 %"}, ""),
        ({"share": "100 %"}, ""),
        ({"share": "101 %"}, "share"),
        ({"length": "1 us to 2 us"}, ""),
        ({"length": "2 us to 1 us"}, "length"),
        ({"access": "both"}, "access"),
    ],
)
def test_limits_of_the_keys_of_a_stretch(table: dict[str, Any], message: str):
    check(StretchTable, {"length": "1 us", **table}, message)


def test_a_stretch_may_be_a_length_alone():
    short, whole = ({"model": "m", "stretch": stretch} for stretch in ("1 us", {"length": "1 us"}))
    assert DeviceTable.model_validate(short) == DeviceTable.model_validate(whole)


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        ({"kind": "nack", "bytes": [0]}, ""),
        ({"kind": "nack", "bit": 1}, "a fault of kind 'nack' has no bit; leave it out"),
        ({"kind": "nack", "bit": 1, "clocks": 1}, "a fault of kind 'nack' has no bit and no clocks; leave it out"),
        ({"kind": "wrong", "value": 0}, ""),
        ({"kind": "wrong"}, "a wrong byte needs its value, value = 0xFF for instance"),
        ({"kind": "wrong", "value": 1, "access": "write"}, "is about bytes that the device sends, 1 and up of a read"),
        ({"kind": "wrong", "value": 1, "bytes": [1, 0]}, "is about bytes that the device sends, 1 and up of a read"),
        ({"kind": "wrong", "value": 1, "bytes": [1], "access": "read"}, ""),
        ({"kind": "flip"}, ""),
        ({"kind": "flip", "bit": 0}, ""),
        ({"kind": "flip", "bit": 7}, ""),
        ({"kind": "flip", "bit": 8}, "expected 0 to 7"),
        ({"kind": "flip", "bit": -1}, "expected 0 to 7"),
        ({"kind": "flip", "access": "write"}, "is about bytes that the device sends"),
        ({"kind": "nack", "access": "write", "bytes": [0]}, ""),
        ({"kind": "hold", "clocks": 1}, ""),
        ({"kind": "hold", "length": "1 us"}, ""),
        ({"kind": "hold", "clocks": 0}, "clocks"),
        ({"kind": "hold"}, "SDA is held either for a length or for a number of clocks; give one of them"),
        ({"kind": "hold", "clocks": 1, "length": "1 us"}, "SDA is held either for a length or for a number of clocks"),
        ({"kind": "off", "after": "1 ms", "until": "2 ms"}, ""),
        ({"kind": "off", "share": "50 %"}, "a fault of kind 'off' has no share; leave it out"),
        ({"kind": "off", "bytes": [1], "access": "read"}, "a fault of kind 'off' has no access and no bytes"),
        ({"kind": "off", "after": "1 ms", "until": "1 ms"}, "'until' is not later than 'after', so nothing"),
        ({"kind": "off", "after": "1 ms", "until": "1.001 ms"}, ""),
    ],
)
def test_the_keys_of_a_fault(fault: dict[str, Any], message: str):
    check(DeviceFault, fault, message)


@pytest.mark.parametrize(
    ("length", "words"),
    [
        (Fraction(3), "3 s"),
        (Fraction(3, 1000), "3 ms"),
        (Fraction(1500, 1000), "1500 ms"),
        (Fraction(7, 10**6), "7 us"),
        (Fraction(7, 10**9), "7 ns"),
        (Fraction(1, 3), "1/3 s"),
    ],
)
def test_a_length_has_the_largest_unit_in_which_it_is_whole(length: Fraction, words: str):
    assert in_words(length) == words


SEND = {"to": "dsp.SCI-A", "at": "1 ms", "bytes": "55"}
EXPECT = {"name": "e", "from": "dsp.SCI-A", "at": "1 ms", "text": "OK", "within": "1 ms"}
OWN = {"baud": 9600, "bits": 8, "parity": "odd", "stop": 1, "multiprocessor": "none"}


@pytest.mark.parametrize("kind", [SendTable, ExpectTable])
def test_an_entry_has_the_format_of_its_table_or_its_own(kind: Any):
    table = SerialTable.model_validate(
        {"baud": 1200, "bits": 7, "parity": "even", "stop": 2, "multiprocessor": "address-bit", "ppm": 20}
    )
    needed = SEND if kind is SendTable else EXPECT
    plain, own = kind.model_validate(needed), kind.model_validate(needed | OWN)
    for entry in (None, plain):
        assert (table.bit(entry), table.form(entry)) == (Fraction(1, 1200), UartFormat(7, "even", 2, True))
        assert (table.value("multiprocessor", entry), table.value("ppm", entry)) == ("address-bit", 20)
    assert (table.bit(own), table.form(own)) == (Fraction(1, 9600), UartFormat(8, "odd", 1, False))
    assert table.value("multiprocessor", own) == "none"


@pytest.mark.parametrize(("ppm", "clock"), [(None, 20), (0, 0), (-7, -7)])
def test_a_send_may_have_a_clock_of_its_own(ppm: int | None, clock: int):
    send = SendTable.model_validate(SEND | ({} if ppm is None else {"ppm": ppm}))
    assert SerialTable.model_validate({"ppm": 20}).value("ppm", send) == clock


TEXT = {key: value for key, value in SEND.items() if key != "bytes"}


@pytest.mark.parametrize(
    ("kind", "table", "message"),
    [
        *((SerialTable, {"baud": baud}, "") for baud in (1, 10_000_000)),
        *((SerialTable, {"baud": baud}, "baud") for baud in (0, 10_000_001)),
        *((SerialTable, {"bits": bits, "stop": stop}, "") for bits, stop in ((1, 1), (8, 2))),
        *((SerialTable, {"bits": bits}, "bits") for bits in (0, 9)),
        *((SerialTable, {"stop": stop}, "stop") for stop in (0, 3)),
        (SendTable, SEND | {"times": 1, "period": "1 ms", "wrong_parity": [0], "missing_stop": [0]}, ""),
        (SendTable, SEND | {"times": 0, "period": "1 ms"}, "times"),
        (SendTable, SEND | {"wrong_parity": [-1]}, "wrong_parity"),
        (SendTable, SEND | {"missing_stop": [-1]}, "missing_stop"),
        (SendTable, SEND | {"text": "U"}, "text and bytes cannot both be; leave one of them out"),
        (SendTable, TEXT, "a send needs one of text, bytes, file and break"),
        (SendTable, SEND | {"after": "x"}, "at and after cannot both be; leave one of them out"),
        (SendTable, {"to": "dsp.SCI-A", "bytes": "55"}, "a send needs one of at, after, after_text and after_bytes"),
        (SendTable, TEXT | {"text": ""}, "text is empty; write at least one character"),
        (SendTable, SEND | {"bytes": ""}, "bytes is empty; write at least one character"),
        (SendTable, {"to": "dsp.SCI-A", "text": "U", "after_text": ""}, "after_text is empty; write at least one"),
        (SendTable, {"to": "dsp.SCI-A", "text": "U", "after_bytes": ""}, "after_bytes is empty; write at least one"),
        (
            SendTable,
            SEND | {"times": 2},
            "times needs period, since a time comes once; give period, or leave times out",
        ),
        (SendTable, {"to": "dsp.SCI-A", "text": "U", "after_text": "x", "times": 2}, ""),
        (SendTable, TEXT | {"break": "1 ms"}, ""),
        (SendTable, TEXT | {"break": "0 s"}, "break"),
        (SendTable, TEXT | {"break": "1 ms", "address": 0}, "a break has no characters; send them apart"),
        (SendTable, TEXT | {"break": "1 ms", "wrong_parity": [0]}, "a break has no characters; send them apart"),
        (SendTable, TEXT | {"break": "1 ms", "missing_stop": [0]}, "a break has no characters; send them apart"),
        (ExpectTable, EXPECT | {"bytes": "55"}, "text and bytes cannot both be; leave one of them out"),
        (ExpectTable, EXPECT | {"after": "x"}, "after and at cannot both be; leave one of them out"),
        (ExpectTable, EXPECT | {"text": ""}, "text is empty; write at least one character"),
        (ExpectTable, EXPECT | {"within": "0 s"}, "within"),
    ],
)
def test_a_serial_table_at_its_limits(kind: Any, table: dict[str, Any], message: str):
    check(kind, table, message)


STRIKES = {"bytes": [], "access": "any", "phases": [], "share": "100 %", "after": "0 s"}
UNIT = {"unit": {"dsp": {"firmware": "x", "modules": ["I2C-A"]}}}
CHIP = {"chip": {"it": {"model": "m", "values": {"fixed": [0, 0, 0]}}}}
ONE_SEND = {"serial": {"send": [{"to": "dsp.SCI-A", "at": "1 ms", "bytes": "55"}]}}
ONE_EXPECT = {"serial": {"expect": [{"name": "e", "from": "dsp.SCI-A", "at": "1 ms", "text": "OK", "within": "1 ms"}]}}


def joined(one: Any, more: Any) -> Any:
    """Return a tree with the keys of another tree merged into its tables."""
    if isinstance(more, list) and isinstance(one, list) and one:
        return [joined(a, b) for a, b in zip(one, more, strict=True)]
    if not isinstance(more, dict):
        return more
    return one | {key: joined(one.get(key, {}), value) for key, value in more.items()}


@pytest.mark.parametrize(
    ("needed", "left_out"),
    [
        ({}, {"about": "", "start": "0 s", "seed": 0, "disable": [], "strict": False, "stall_limit": "10 s"}),
        ({}, {"cable": [], "transceiver": [], "fault": [], "budget": [], "breaks": [], "watch": {}, "device": {}}),
        (UNIT, {"unit": {"dsp": {"oscclk": "30 MHz", "pll": 10, "ppm": 0, "from_boot": False, "skip_polls": True}}}),
        (
            UNIT,
            {"unit": {"dsp": {"code": {"between_accesses": 5, "poll_pass": 10, "isr_prologue": 17}}}},
        ),
        (UNIT, {"unit": {"dsp": {"code": {"isr_epilogue": 13}, "pins": {}, "settings": {}, "options": {}}}}),
        (
            {"unit": {"dsp": {"image": "x.out", "modules": [], "stub": [{"register": 1, "value": 2}]}}},
            {"unit": {"dsp": {"boot": "entry", "stub": [{"after": "0 s"}], "memory": {}}}},
        ),
        (
            {"unit": {"dsp": {"sources": ["x.c"], "modules": []}}},
            {"unit": {"dsp": {"compile": {"include": [], "defines": {}, "undefined": False}}}},
        ),
        (
            {"transceiver": [{"on": "dsp.SCI-A", "de": "dsp.GPIO34"}]},
            {"transceiver": [{"pair": "RS485", "hears_itself": False, "pull": "down"}]},
        ),
        (
            {"controller": {}},
            {"controller": {"rate": "100 kHz", "ppm": 0, "hold": "300 ns", "filter": "0 s", "first": "5 ms"}},
        ),
        (
            {"controller": {}},
            {"controller": {"period": "20 ms", "jitter": "0 s", "gap": "50 us", "pointer_by": "repeated START"}},
        ),
        (
            {"controller": {}},
            {"controller": {"check": "expect", "on_nack": "go on", "stuck_after": "25 ms", "beside_outside": False}},
        ),
        (
            {"controller": {"request": [{"name": "r", "address": 1}]}},
            {"controller": {"request": [{"count": 6, "write": ""}]}},
        ),
        (
            {"rounds": {"period": "20 ms"}},
            {"rounds": {"pointer_by": "repeated START", "check": "expect", "ack_polling": False}},
        ),
        ({"rounds": {"period": "20 ms"}}, {"rounds": {"stuck_after": "25 ms", "order": [], "request": []}}),
        (
            {"host": {}},
            {"host": {"baud": 115_200, "error": 0, "ppm": 0, "first": "2 ms", "period": "20 ms", "jitter": "0 s"}},
        ),
        ({"host": {}}, {"host": {"gap": 0, "paced_by": "schedule", "lose": [], "silent": [], "twice": []}}),
        (
            {"serial": {}},
            {"serial": {"baud": 115_200, "bits": 8, "parity": "none", "stop": 1, "multiprocessor": "none"}},
        ),
        ({"serial": {}}, {"serial": {"ppm": 0, "turnaround": "0 s", "send": [], "expect": []}}),
        (ONE_SEND, {"serial": {"send": [{"encoding": "ascii", "delay": "0 s", "gap": "0 s"}]}}),
        (ONE_SEND, {"serial": {"send": [{"wrong_parity": [], "missing_stop": []}]}}),
        (ONE_EXPECT, {"serial": {"expect": [{"encoding": "ascii", "anywhere": False, "why": ""}]}}),
        (CHIP, {"chip": {"it": {"output_delay": "300 ns", "powered": "1 s", "registers": {}, "options": {}}}}),
        (
            {"chip": {"it": {"model": "m", "values": {"ramp": "angles"}}}},
            {"chip": {"it": {"values": {"first": "10 ms", "period": "20 ms", "unit": "physical"}}}},
        ),
        ({"device": {"it": {"model": "m"}}}, {"device": {"it": {"output_delay": "300 ns", "fault": []}}}),
        (
            {"device": {"it": {"model": "m", "stretch": {"length": "1 us"}}}},
            {"device": {"it": {"stretch": STRIKES}}},
        ),
        (
            {"device": {"it": {"model": "m", "fault": [{"kind": "nack"}]}}},
            {"device": {"it": {"fault": [STRIKES]}}},
        ),
        (
            {"budget": [{"name": "b", "measure": "round", "max": "1 s"}]},
            {"budget": [{"coverage": "90 %", "and": [], "why": "", "source": ""}]},
        ),
    ],
)
def test_a_key_that_is_left_out_has_its_default(needed: dict[str, Any], left_out: dict[str, Any]):
    tree = {"name": "x", "duration": "1 s", "unit": {}, **needed}
    whole = joined(tree, left_out)
    assert whole != tree
    assert Case.model_validate(tree) == Case.model_validate(whole)

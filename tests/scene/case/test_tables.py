"""The tables of a case at the limits of their keys: what is just taken, and what is just refused."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.core.convert import BadTable
from periph_sim.scene.case.model import Case

PYTHON, IMAGE, SOURCES = (
    {"modules": [], **one} for one in ({"firmware": "x"}, {"image": "x.out"}, {"sources": ["x.c"]})
)
READ = {"address": 0x10}


def unit(table: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"unit": {"dsp": table | more}}


def request(**table: Any) -> dict[str, Any]:
    return {"controller": {"request": [table]}}


def values(**table: Any) -> dict[str, Any]:
    return {"chip": {"it": {"model": "m", "values": table}}}


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        (unit(PYTHON), ""),
        (unit({"modules": []}), "a unit needs a program; give firmware, or image"),
        (unit(PYTHON, image="x.out"), "a unit has one program; give firmware or image, not both"),
        (unit(SOURCES, settings={}), "settings is of Python firmware; sources take [unit.NAME.compile] defines"),
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
def test_a_table_at_its_limits(tables: dict[str, Any], said: str):
    tree = {"name": "x", "duration": "1 s", **tables}
    if not said:
        Case.model_validate(tree)
        return
    with pytest.raises(BadTable) as caught:
        Case.model_validate(tree)
    assert said in str(caught.value)

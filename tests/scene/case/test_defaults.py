"""What a case means by the keys that it leaves out: it is equal to the same case with each of them written."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.scene.case.model import Case

STRIKES = {"bytes": [], "access": "any", "phases": [], "share": "100 %", "after": "0 s"}
UNIT = {"unit": {"dsp": {"firmware": "x", "modules": ["I2C-A"]}}}
CHIP = {"chip": {"it": {"model": "m", "values": {"fixed": [0, 0, 0]}}}}
SEND = {"serial": {"send": [{"to": "dsp.SCI-A", "at": "1 ms", "bytes": "55"}]}}
EXPECT = {"serial": {"expect": [{"name": "e", "from": "dsp.SCI-A", "at": "1 ms", "text": "OK", "within": "1 ms"}]}}


def joined(one: Any, more: Any) -> Any:
    """A tree with the keys of another one in its tables."""
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
        (SEND, {"serial": {"send": [{"encoding": "ascii", "delay": "0 s", "gap": "0 s"}]}}),
        (SEND, {"serial": {"send": [{"wrong_parity": [], "missing_stop": []}]}}),
        (EXPECT, {"serial": {"expect": [{"encoding": "ascii", "anywhere": False, "why": ""}]}}),
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
def test_a_key_that_is_left_out_is_as_if_written_so(needed: dict[str, Any], left_out: dict[str, Any]):
    tree = {"name": "x", "duration": "1 s", "unit": {}, **needed}
    whole = joined(tree, left_out)
    assert whole != tree
    assert Case.model_validate(tree) == Case.model_validate(whole)

"""The wire of each pin, by modules, named pins and cables, and cables that are refused."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.scene.case.model import BadCase
from periph_sim.scene.case.wiring import wiring_of
from periph_sim.scene.scope import scope_of_case
from tests.scene.small import case, sentence_of


def unit(*modules: str, **pins: int) -> dict[str, Any]:
    return {"firmware": "responder", "modules": list(modules), "pins": pins}


def cable(begin: str, end: str, **more: str) -> dict[str, str]:
    return {"from": begin, "to": end, **more}


def pins(cables: list[dict[str, str]] | None = None, host: bool = False, **units: Any) -> dict[str, dict[int, str]]:
    more = {"host": {}} if host else {}
    wiring = wiring_of(case(unit=units, cable=cables or [], **more))
    return {name: dict(found) for name, found in wiring.pins.items()}


def test_one_unit_has_plain_names():
    found = pins(dsp=unit("I2C-A", "SCI-A", "SCI-B", "SCI-C", DE=34))
    assert found == {
        "dsp": {
            32: "SDA",
            33: "SCL",
            28: "RX",
            29: "TX",
            19: "SCI-B.RX",
            18: "SCI-B.TX",
            62: "SCI-C.RX",
            63: "SCI-C.TX",
            34: "DE",
        }
    }


def test_units_share_the_bus_but_no_serial_line():
    left, right = pins(left=unit("I2C-A", "SCI-A"), right=unit("I2C-A", "SCI-A")).values()
    assert left == {32: "SDA", 33: "SCL", 28: "left.SCI-A.RX", 29: "left.SCI-A.TX"}
    assert right == {32: "SDA", 33: "SCL", 28: "right.SCI-A.RX", 29: "right.SCI-A.TX"}


def test_a_host_sends_to_every_sci_a():
    found = pins(host=True, left=unit("SCI-A"), right=unit("SCI-A"))
    assert [found[name][28] for name in found] == ["RX", "RX"]
    assert [found[name][29] for name in found] == ["left.SCI-A.TX", "right.SCI-A.TX"]


def test_a_wire_has_the_name_of_its_cable_or_of_the_start_of_it():
    both = [cable("left.SCI-A.TX", "right.SCI-B.RX"), cable("right.SCI-B.TX", "left.SCI-A.RX", name="BACK")]
    found = pins(both, left=unit("SCI-A"), right=unit("SCI-B"))
    assert found == {
        "left": {28: "BACK", 29: "left.SCI-A.TX"},
        "right": {19: "left.SCI-A.TX", 18: "BACK"},
    }


def test_an_end_of_a_cable_may_omit_the_unit_or_be_a_named_pin():
    named = [cable("SCI-A.TX", "GPIO_IN"), cable("left.GPIO12", "right.GPIO13"), cable("SDA", "right.GPIO5")]
    found = pins(named, left=unit("SCI-A", "I2C-A"), right=unit(GPIO_IN=7))
    assert found["left"] == {32: "SDA", 33: "SCL", 28: "RX", 29: "GPIO_IN", 12: "left.GPIO12"}
    assert found["right"] == {7: "GPIO_IN", 13: "left.GPIO12", 5: "SDA"}


def test_other_pins_of_a_module_are_wired_by_a_cable():
    found = pins([cable("dsp.SCI-B.RX", "dsp.GPIO23")], dsp=unit("SCI-B"))
    assert found["dsp"] == {19: "dsp.SCI-B.RX", 23: "dsp.SCI-B.RX", 18: "SCI-B.TX"}


def test_budgets_know_the_lines_and_recordings_list_them():
    of = case(unit={"dsp": unit("SCI-A", "SCI-C", MODEL=34)}, cable=[cable("dsp.SCI-C.TX", "dsp.GPIO3")])
    assert scope_of_case(of).lines == ("RX", "TX", "SCI-C.RX", "dsp.SCI-C.TX")
    assert of.recorded_modules == {"dsp": ("SCI-A", "SCI-C", "pin:SCI-C.RX", "pin:dsp.SCI-C.TX", "pin:MODEL")}
    assert [(sci.module, sci.rx, sci.tx) for sci in wiring_of(of).scis] == [
        ("SCI-A", "RX", "TX"),
        ("SCI-C", "SCI-C.RX", "dsp.SCI-C.TX"),
    ]


LEFT_AND_RIGHT = {"left": unit("SCI-A", "SCI-B"), "right": unit("SCI-A", ONE=1, TWO=2)}


@pytest.mark.parametrize(
    ("cables", "message"),
    [
        ([cable("lft.SCI-A.TX", "right.SCI-A.RX")], "cable.0.from: there is no unit 'lft'; did you mean left?"),
        (
            [cable("left.SCI-C.TX", "right.SCI-A.RX")],
            "cable.0.from: unit left has no SCI-C; add it to its modules",
        ),
        (
            [cable("left.SCI-A.TX", "right.SCI-A.RXD")],
            "cable.0.to: there is no pin 'right.SCI-A.RXD'; did you mean right.SCI-A.RX",
        ),
        ([cable("left.GPIO88", "right.GPIO1")], "cable.0.from: left.GPIO88: the pins are GPIO0 to GPIO87"),
        (
            [cable("SCI-A.TX", "left.SCI-B.RX")],
            "cable.0.from: left and right have SCI-A; say whose is meant: left.SCI-A.TX",
        ),
        ([cable("left.SCI-A.TX", "left.GPIO29")], "cable.0: it joins left.GPIO29 with itself; a cable has two ends"),
        (
            [cable("left.SCI-A.TX", "right.SCI-A.RX"), cable("left.SCI-B.TX", "right.SCI-A.RX")],
            "cable.1: left.SCI-A.TX and left.SCI-B.TX would drive one wire; "
            "give each of them a wire, or a transceiver to share one",
        ),
        ([cable("ONE", "TWO")], "cable.0: it joins ONE and TWO, two names of one wire; give it one"),
    ],
)
def test_an_invalid_cable_is_refused(cables: list[dict[str, str]], message: str):
    assert sentence_of(BadCase, lambda: wiring_of(case(unit=LEFT_AND_RIGHT, cable=cables))).startswith(
        f"case small: {message}"
    )


def test_a_line_that_the_host_drives_cannot_have_a_second_driver():
    with pytest.raises(BadCase, match=r"cable\.0: right\.SCI-A\.TX and the host would drive one wire"):
        pins([cable("right.SCI-A.TX", "RX")], host=True, left=unit("SCI-B"), right=unit("SCI-A"))


@pytest.mark.parametrize(
    ("units", "transceivers", "found"),
    [
        ({"dsp": unit("I2C-A", "SCI-A")}, [], {"dsp": ("I2C-A", "SCI-A")}),
        ({"dsp": unit("GPIO", LED=12)}, [], {"dsp": ("GPIO", "pin:LED")}),
        (
            {"dsp": unit("SCI-A", "GPIO", DE=34)},
            [{"on": "SCI-A", "de": "DE"}],
            {"dsp": ("SCI-A", "GPIO", "pin:DE", "pin:RS485")},
        ),
        (
            {"left": unit("SCI-B", "GPIO", DE=34), "right": unit("SCI-B", "GPIO", OE=5)},
            [{"on": "left.SCI-B", "de": "DE"}, {"on": "right.SCI-B", "de": "OE", "pair": "OTHER"}],
            {
                "left": ("SCI-B", "GPIO", "pin:left.SCI-B.RX", "pin:left.SCI-B.TX", "pin:DE", "pin:RS485"),
                "right": ("SCI-B", "GPIO", "pin:right.SCI-B.RX", "pin:right.SCI-B.TX", "pin:OE", "pin:OTHER"),
            },
        ),
        (
            {"left": unit("GPIO", BUSY=7), "right": unit("GPIO", BUSY=8)},  # one wire, listed with the first unit
            [],
            {"left": ("GPIO", "pin:BUSY"), "right": ("GPIO",)},
        ),
    ],
)
def test_a_recording_lists_modules_and_wires_with_other_than_the_usual_names(
    units: dict[str, Any], transceivers: list[dict[str, str]], found: dict[str, tuple[str, ...]]
):
    assert case(unit=units, transceiver=transceivers).recorded_modules == found

"""Channels found by their usual names: with scopes, in parentheses, or after the name of a device."""

from __future__ import annotations

import pytest

from periph_sim.traces.capture.channel_names import buses_named, channels_named
from tests.traces.decode.drawing import drawn, of_bytes


def found(line: str, *names: str) -> list[str]:
    return [channel.name for channel in channels_named(of_bytes(b"\0", names), line)]


@pytest.mark.parametrize("name", ["SCL", "scl ", "tb.bus.scl", "Channel 0 (SCL)", "24LC515 SCL", "i2c_scl", "SCL/A5"])
def test_a_channel_is_found_if_its_name_has_the_line_as_a_word(name: str):
    assert found("scl", "D7", name) == [name]


@pytest.mark.parametrize("name", ["SCL2", "MISCL", "0", "SDA", "scl.enable"])
def test_a_channel_with_another_name_is_not_found(name: str):
    assert found("scl", name) == []


def test_the_exact_name_takes_precedence_and_otherwise_all_matches_are_found():
    assert found("rx", "RX", "RX ready") == ["RX"]
    assert found("rx", "host RX", "RX ready") == ["host RX", "RX ready"]


@pytest.mark.parametrize(
    ("names", "i2c", "uart", "left_over"),
    [
        ("SCL SDA", "SCL/SDA", "", ""),
        ("sda D1 i2c_scl", "i2c_scl/sda", "", ""),
        ("Channel_0_(SDA) Channel_1_(SCL)", "Channel_1_(SCL)/Channel_0_(SDA)", "", ""),
        ("SCL2 SDA2 SCL1 SDA1", "SCL2/SDA2 SCL1/SDA1", "", ""),
        ("24LC515_SCL LM75_SCL LM75_SDA 24LC515_SDA", "24LC515_SCL/24LC515_SDA LM75_SCL/LM75_SDA", "", ""),
        (
            "Channel_0_(A_SCL) Channel_1_(A_SDA) D2_B_SCL D3_B_SDA",
            "Channel_0_(A_SCL)/Channel_1_(A_SDA) D2_B_SCL/D3_B_SDA",
            "",
            "",
        ),
        ("SCL SDA SCL_B SDA_B", "SCL/SDA SCL_B/SDA_B", "", ""),
        ("SCL_A SDA_A SCL_B", "SCL_A/SDA_A", "", "SCL_B"),
        ("SCL SDA_A SDA_B", "", "", "SCL SDA_A SDA_B"),
        ("tb.a.scl tb.a.sda tb.b.scl tb.b.sda", "tb.a.scl/tb.a.sda tb.b.scl/tb.b.sda", "", ""),
        ("UART_RX GPS_TX host.rx MISCL RXD scl.enable", "", "UART_RX GPS_TX host.rx", ""),
    ],
)
def test_lines_of_a_bus_are_grouped_by_their_names(names: str, i2c: str, uart: str, left_over: str):
    found = buses_named(of_bytes(b"\0", tuple(name.replace("_", " ") for name in names.split())))
    assert [f"{scl.name}/{sda.name}".replace(" ", "_") for scl, sda in found.i2c] == i2c.split()
    assert [line.name.replace(" ", "_") for line in found.uart] == uart.split()
    assert [line.name.replace(" ", "_") for line in found.left_over] == left_over.split()


def test_equal_wires_in_several_scopes_are_one_bus():
    found = buses_named(
        drawn(
            """
            tb.scl      --_-_-
            tb.sda      -__---
            tb.dut.scl  --_-_-
            tb.dut.sda  -__---
            tb.old.rx   ------
            tb.new.rx   ------
            """
        )
    )
    assert [(scl.name, sda.name) for scl, sda in found.i2c] == [("tb.scl", "tb.sda")]
    assert len(found.uart) == 2

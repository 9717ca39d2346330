"""Registers that make up the address of an operand, by its field [SPRU430F Table 5-1]."""

from __future__ import annotations

import pytest

from periph_sim.processor.c28x.pipeline import BY_ARP, DP, SP, addressing


def ar(*numbers: int) -> int:
    return sum(1 << number for number in numbers)


@pytest.mark.parametrize(
    ("field", "registers"),
    [
        (0x00, DP),  # @6bit
        (0x3F, DP),
        (0x40, SP),  # *-SP[6bit]
        (0x7F, SP),
        (0x80, ar(0)),  # *XAR0++
        (0x8F, ar(7)),  # *--XAR7
        (0x90, ar(0)),  # *+XAR0[AR0]
        (0x97, ar(7, 0)),
        (0x98, ar(0, 1)),  # *+XAR0[AR1]
        (0x9F, ar(7, 1)),
        (0xA0, 0),  # @AR0: no address
        (0xA7, 0),
        (0xA9, 0),  # @AL
        (0xAE, BY_ARP | ar(0)),  # *0++
        (0xAF, BY_ARP | ar(0)),  # *0--
        (0xB0, BY_ARP),  # *,ARP0
        (0xB8, BY_ARP),  # *
        (0xBB, BY_ARP | ar(0)),  # *BR0++
        (0xBC, BY_ARP | ar(0)),  # *BR0--
        (0xBD, SP),  # *SP++
        (0xBE, SP),  # *--SP
        (0xBF, ar(6, 1)),  # *AR6%++
        (0xC3, ar(3)),  # *+XAR3[0]
        (0xFF, ar(7)),
    ],
)
def test_the_registers_of_an_address(field: int, registers: int):
    assert addressing(field) == registers

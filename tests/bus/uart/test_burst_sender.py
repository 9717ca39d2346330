"""Bursts on a wire: the bits of correct and faulty characters, breaks, and consecutive bursts."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.bus.uart.burst_sender import Burst, BurstSender, Character
from periph_sim.bus.uart.frame_format import UartFormat
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.sampler import watch
from periph_sim.core.wire import Wire

BIT = Fraction(100)


def levels(character: Character, form: UartFormat) -> str:
    return "".join(map(str, character.levels(form)))


@pytest.mark.parametrize(
    ("character", "form", "drawn"),
    [
        (Character(0x55), UartFormat(), "0 10101010 1"),
        (Character(0x01), UartFormat(parity="even"), "0 10000000 1 1"),
        (Character(0x01, wrong_parity=True), UartFormat(parity="even"), "0 10000000 0 1"),
        (Character(0x01, wrong_parity=True), UartFormat(parity="odd", stop=2), "0 10000000 1 11"),
        (Character(0x01, address=1), UartFormat(address=True), "0 10000000 1 1"),
        (Character(0x01, address=1), UartFormat(parity="even", address=True), "0 10000000 1 0 1"),
        (Character(0x01, missing_stop=True), UartFormat(), "0 10000000 0 1"),
        (Character(0x01, missing_stop=True), UartFormat(stop=2), "0 10000000 00 1"),
    ],
)
def test_bits_of_a_character(character: Character, form: UartFormat, drawn: str):
    assert levels(character, form) == drawn.replace(" ", "")


class SenderRig:
    """A sender on a wire.

    edges: (tick, level) of each edge of the wire
    calls: ("begin" or "end", tick) of each callback of the sender
    """

    def __init__(self) -> None:
        self.kernel = Kernel(0)
        wire = Wire(self.kernel, "RX", Recorder())
        self.edges: list[tuple[int, int]] = []
        self.calls: list[tuple[str, int]] = []
        watch([wire], lambda tick, level: self.edges.append((tick, level)))
        self.sender = BurstSender(self.kernel, wire.attach("serial"), "serial")

    def send(self, at: int, burst: Burst) -> None:
        begins, ends = (lambda tick, what=what: self.calls.append((what, tick)) for what in ("begin", "end"))
        self.kernel.call_at(at, lambda: self.sender.send(burst, begins, ends))

    def run(self) -> list[tuple[int, int]]:
        self.kernel.run_until(100_000)
        return self.edges


def test_characters_with_a_gap_and_the_callbacks_at_begin_and_end():
    rig = SenderRig()
    rig.send(50, Burst(BIT, UartFormat(), (Character(0xFF), Character(0xFF)), gap=30))
    assert rig.run() == [(50, 0), (150, 1), (1080, 0), (1180, 1)]
    assert rig.calls == [("begin", 50), ("end", 2080)]
    assert rig.sender.characters == 2


def test_bursts_are_sent_in_order_and_an_address_waits_for_an_idle_line():
    rig = SenderRig()
    one = (Character(0xFF),)
    rig.send(50, Burst(BIT, UartFormat(), one))
    rig.send(60, Burst(BIT, UartFormat(), one))
    rig.send(70, Burst(BIT, UartFormat(), one, idle=11))
    rig.run()
    assert [tick for what, tick in rig.calls if what == "begin"] == [50, 1050, 2050 + 1100]


def test_a_break_lasts_for_its_given_length():
    rig = SenderRig()
    rig.send(50, Burst(BIT, UartFormat(), low=1234))
    assert rig.run() == [(50, 0), (1284, 1)]
    assert rig.calls == [("begin", 50), ("end", 1284)]


def test_bits_of_a_fractional_number_of_ticks_do_not_drift():
    rig = SenderRig()
    bit = Fraction(1000, 3)
    rig.send(0, Burst(bit, UartFormat(), tuple(Character(0xFF) for _ in range(9))))
    falls = [tick for tick, level in rig.run() if not level]
    assert falls == [int(10 * n * bit) for n in range(9)]

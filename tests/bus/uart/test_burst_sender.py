"""Bursts on a wire: right and wrong characters bit by bit, breaks, and one burst after the other."""

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


class Desk:
    """A wire and the sender on it; `edges` as they happen, `told` of begins and ends."""

    def __init__(self) -> None:
        self.kernel = Kernel(0)
        wire = Wire(self.kernel, "RX", Recorder())
        self.edges: list[tuple[int, int]] = []
        self.told: list[tuple[str, int]] = []
        watch([wire], lambda tick, level: self.edges.append((tick, level)))
        self.sender = BurstSender(self.kernel, wire.attach("serial"), "serial")

    def send(self, at: int, burst: Burst) -> None:
        begins, ends = (lambda tick, what=what: self.told.append((what, tick)) for what in ("begin", "end"))
        self.kernel.call_at(at, lambda: self.sender.send(burst, begins, ends))

    def run(self) -> list[tuple[int, int]]:
        self.kernel.run_until(100_000)
        return self.edges


def test_characters_with_a_gap_and_what_is_told():
    desk = Desk()
    desk.send(50, Burst(BIT, UartFormat(), (Character(0xFF), Character(0xFF)), gap=30))
    assert desk.run() == [(50, 0), (150, 1), (1080, 0), (1180, 1)]
    assert desk.told == [("begin", 50), ("end", 2080)]
    assert desk.sender.characters == 2


def test_bursts_follow_each_other_and_an_address_waits_for_an_idle_line():
    desk = Desk()
    one = (Character(0xFF),)
    desk.send(50, Burst(BIT, UartFormat(), one))
    desk.send(60, Burst(BIT, UartFormat(), one))
    desk.send(70, Burst(BIT, UartFormat(), one, idle=11))
    desk.run()
    assert [tick for what, tick in desk.told if what == "begin"] == [50, 1050, 2050 + 1100]


def test_a_break_lasts_as_long_as_it_says():
    desk = Desk()
    desk.send(50, Burst(BIT, UartFormat(), low=1234))
    assert desk.run() == [(50, 0), (1284, 1)]
    assert desk.told == [("begin", 50), ("end", 1284)]


def test_bits_of_a_rate_that_is_no_whole_number_do_not_drift():
    desk = Desk()
    bit = Fraction(1000, 3)
    desk.send(0, Burst(bit, UartFormat(), tuple(Character(0xFF) for _ in range(9))))
    falls = [tick for tick, level in desk.run() if not level]
    assert falls == [int(10 * n * bit) for n in range(9)]

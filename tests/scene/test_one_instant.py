"""Changes at one time are one sample: the order in which parties act or listen has no effect.

The master here behaves as RTL does: SCL falls and SDA changes on one clock edge, a hold time of 0, as UM10204 allows.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cache, partial
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.bus.i2c.controller import I2cController
from periph_sim.bus.i2c.line_observers import BusRecorder
from periph_sim.bus.i2c.monitor import I2cMonitor
from periph_sim.bus.i2c.replayed_sides import Answer, ScriptedTarget
from periph_sim.bus.i2c.transfer import BusTiming, Transfer
from periph_sim.core.records import Kind
from tests.scene.runs import recorded
from tests.scene.small import case

CYCLE = 20  # ticks
HALF = 15_000  # ticks of half a bit at 100 kHz
BEGIN = 3_000_000
Reorder = Callable[[list[Any]], None]
Move = tuple[int, str, int]  # tick, line, level

UNIT = 0x50  # its firmware holds the data "5a c3"
TARGET = 0x21  # the address of an agent
SCRIPT = "S 50W 12 ff 00 P S 50R . ! P S 21W 55 S 21R . . ! P S 0aW P S 50R ! P"


def moves(script: str) -> Iterator[Move]:
    """Yield the master's moves: S START, P STOP, 50W an address, hex a byte, . a byte read, ! the last byte read."""
    at, free = BEGIN, True

    def bits(levels: list[int]) -> Iterator[Move]:
        nonlocal at
        for level in levels:
            yield from ((at, "SCL", 0), (at, "SDA", level), (at + HALF, "SCL", 1))
            at += 2 * HALF

    for word in script.split():
        if word == "S":
            if not free:
                yield from bits([1])
            yield at - HALF // 2, "SDA", 0
            free = False
        elif word == "P":
            yield from bits([0])
            yield at - HALF // 2, "SDA", 1
            at, free = at + 8 * HALF, True
        elif word in ".!":
            yield from bits([1] * 8 + [int(word == "!")])
        else:
            value = int(word[:2], 16)
            value = value << 1 | (word[-1] == "R") if word[-1] in "RW" else value
            yield from bits([value >> n & 1 for n in range(7, -1, -1)] + [1])


class Bus:
    """Two units, a target and listeners. `reorder` permutes the parties and the master's moves.

    late: ticks by which a move is delayed. alone: without the target, which samples every tick by itself.
    """

    def __init__(
        self, reorder: Reorder, late: Callable[[], int], modules: tuple[str, ...], alone: bool = False
    ) -> None:
        unit = {"firmware": "responder", "modules": modules, "settings": {"replies": ["5a c3", "81"]}}
        both = {"one": unit, "two": unit | {"settings": {"replies": ["42"], "address": 0x51}}}
        self.scene, self.records = recorded(case(unit=both))
        kernel, recorder = self.scene.kernel, self.scene.recorder
        scl, sda = self.scene.wire("SCL"), self.scene.wire("SDA")
        self.transfers: list[Transfer] = []
        answers = {TARGET: [Answer(True), Answer(True, b"\x99\x01\x80")]}
        parties: list[Callable[[], object]] = [
            lambda: alone or ScriptedTarget(kernel, scl, sda, answers, hold=0),
            lambda: I2cMonitor(scl, sda, self.transfers.append, {}),
            lambda: setattr(self, "counter", BusRecorder(scl, sda)),
            lambda: setattr(self, "idle", I2cController(kernel, recorder, scl, sda, BusTiming(*[HALF] * 7), "idle")),
            lambda: setattr(self, "hands", {"SCL": scl.attach("RTL"), "SDA": sda.attach("RTL")}),
        ]
        reorder(parties)
        for party in parties:
            party()
        calls = [(at + late(), line, level) for at, line, level in moves(SCRIPT)]
        reorder(calls)
        for at, line, level in calls:
            kernel.call_at(at, partial(self.hands[line].drive, level))
        self.scene.run(Fraction(35, 10_000))

    def transfer_texts(self) -> list[str]:
        """Return the transfers as `I2cMonitor` reports them."""
        return [
            " ".join(
                f"{p.address:02x}{'WR'[p.read]}{'NA'[p.acked]} {(p.got or p.data).hex()}"
                + "".join("NA"[ack] for ack in p.acks)
                for p in transfer.phases
            )
            for transfer in self.transfers
        ]

    def recorded(self, *kinds: Kind) -> list[tuple[object, ...]]:
        """Return records without numbers, those of one tick in alphabetical order, and holders of a line likewise."""
        found = (r for r in self.records if not kinds or r.kind in kinds)
        return sorted((r.tick, r.kind.value, r.where, r.what, r.value, sorted(r.text.split(", "))) for r in found)


def keep_order(calls: list[Any]) -> None:
    """Leave the calls in their order."""


def reverse_order(calls: list[Any]) -> None:
    calls.reverse()


@cache
def plain(modules: tuple[str, ...], alone: bool = False) -> Bus:
    return Bus(keep_order, lambda: 0, modules, alone)


TRANSFERS = ["50WA 12ff00AAA", "50RA 5ac3AN", "21WA 55A 21RA 990180AAN", "0aWN ", "50RA 81N"]


@pytest.mark.parametrize("order", [keep_order, reverse_order], ids=["SCL first", "SDA first"])
def test_sda_may_change_at_the_same_time_as_scl_falls(order):
    assert Bus(order, lambda: 0, ("I2C-A",)).transfer_texts() == TRANSFERS


@pytest.mark.parametrize("modules", [("I2C-A",), ("I2C-A", "GPIO")])
@settings(max_examples=5, deadline=None)
@given(seed=st.integers(0, 2**32))
def test_the_order_of_calls_and_of_listeners_has_no_effect(modules, seed):
    mixed = Bus(random.Random(seed).shuffle, lambda: 0, modules)
    assert plain(modules).transfer_texts() == mixed.transfer_texts() == TRANSFERS
    assert mixed.recorded() == plain(modules).recorded()
    assert mixed.counter.bytes == plain(modules).counter.bytes == 16


@pytest.mark.parametrize("modules", [("I2C-A",), ("I2C-A", "GPIO")])
@settings(max_examples=5, deadline=None)
@given(seed=st.integers(0, 2**32))
def test_changes_within_a_sysclkout_cycle_are_one_instant_for_a_chip(modules, seed):
    """Moves occur anywhere in the cycle before the SYSCLKOUT edge; registers, accesses and interrupts are equal."""
    chance = random.Random(seed)
    mixed = Bus(chance.shuffle, lambda: -chance.randrange(CYCLE), modules, alone=True)
    of_chips = (Kind.FLAG, Kind.ACCESS, Kind.IRQ, Kind.NOTE)
    assert mixed.recorded(*of_chips) == plain(modules, alone=True).recorded(*of_chips)
    assert mixed.recorded(Kind.FLAG)

"""`Session.next_output`: no pin of the case changes before it, and a party that steps only to it misses no change."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from random import Random
from typing import Any

import pytest

from periph_sim.firmware import start_i2c, start_pie
from periph_sim.outside.session import Change, Session
from periph_sim.scene.case.model import Case
from periph_sim.scene.firmware_loader import Firmware
from tests.outside.sessions import BUS, FIRMWARE, Records, case, refuses
from tests.outside.test_serial_line import echo
from tests.profiles import explores

Moves = list[tuple[int, dict[str, int]]]

REGISTERS = {"address": 0x50, "registers": "5A 00 FF 81 7E 33"}
TABLE = {"table": {"0x68": "11 22 33 44 55 66", "0x53": "00 FF 00 FF 00 FF", "0x1E": "A5 5A A5 5A A5 5A"}}


def restless() -> Firmware:
    """Return firmware that sends zeros, and within its bits leaves the bus and comes back, or requests to be master."""

    def main(dsp: Any, settings: Any) -> None:
        draw, i2c = Random(1), dsp.module("I2C-A")
        start_i2c(dsp, 0x50)
        while True:
            i2c.I2CMDR.all = 0x0020  # IRS
            for _ in range(draw.randint(1, 4)):
                i2c.I2CDXR.all = 0
                dsp.compute(draw.randint(1, 3_000))
            if draw.random() < 0.2:
                i2c.I2CMDR.all = 0x2620  # MST, TRX, STT
                dsp.compute(draw.randint(1, 3_000))
            i2c.I2CMDR.IRS = 0

    return Firmware("restless", main, None)


def slow_reader(synchronised: bool = False) -> Firmware:
    """Return firmware that reads received bytes so late that SCL is held, and ignores them."""

    def main(dsp: Any, settings: Any) -> None:
        draw, i2c = Random(1), dsp.module("I2C-A")
        start_i2c(dsp, 0x50)
        if synchronised:
            dsp.eallow()
            dsp.module("GPIO").GPBQSEL1.all = 0
            dsp.edis()
        i2c.I2CMDR.all = 0x0020  # IRS
        while True:
            dsp.compute(draw.randint(1, 20_000))
            if i2c.I2CSTR.RRDY:
                i2c.I2CDRR.all  # noqa: B018

    return Firmware("slow reader", main, None)


def pin_answer() -> Firmware:
    """Return firmware that toggles SDA in an interrupt by SCL, and also at other times."""

    def main(dsp: Any, settings: Any) -> None:
        draw, gpio, xint, pieack = Random(1), dsp.module("GPIO"), dsp.module("XINT"), dsp.module("PIE").PIEACK
        dsp.eallow()
        gpio.GPIOXINT4SEL.GPIOSEL = 1
        gpio.GPBDIR.all = 1
        dsp.edis()
        xint.XINT4CR.all = 0xD  # both edges

        def moved() -> None:
            gpio.GPBTOGGLE.all = 1
            pieack.all = 0x800

        start_pie(dsp, {"XINT4": moved})
        while True:
            dsp.compute(draw.randint(1, 3_000))
            gpio.GPBTOGGLE.all = 1

    return Firmware("pin answer", main, None)


def two_units() -> Case:
    """Return a case with a second unit at another address of the bus."""
    one = {"firmware": str(FIRMWARE / "register_slave.py"), "modules": ["I2C-A"], "settings": REGISTERS}
    return case(unit={"dsp": one, "other": one | {"settings": REGISTERS | {"address": 0x22}}})


PROGRAMS = {
    "slow reader behind synchronised pins": lambda: slow_reader(True),
    "restless": restless,
    "slow reader": slow_reader,
    "program and interrupt at a pin": pin_answer,
}
# Steps per applied change of the lines; firmware that never waits may change a pin at any time, and has 20.
MOST_STEPS = {
    "slow reader behind synchronised pins": 1
}  # from most edges of a byte it is not known that the byte is written
CASES = {
    "slow reader": lambda: case(dsp={"options": {"system": {"pf2_read_ws": 0, "write_lands": 4}}}),
    "slow reader behind synchronised pins": lambda: case(modules=("I2C-A", "GPIO")),
    "program and interrupt at a pin": lambda: case(modules=("GPIO", "XINT"), dsp={"pins": {"SDA": 32, "SCL": 33}}),
    "restless": case,
    "two units": two_units,
    "polling": case,
    "interrupts": lambda: case("register_slave", dsp={"settings": REGISTERS}),
    "synchronised pins and frames": lambda: case(
        "imu_hil", ("I2C-A", "SCI-A", "GPIO"), {"settings": TABLE}, host={"period": "400 us"}, seed=1
    ),
}


def traffic(addresses: tuple[int, ...], seed: int, end: int, half: int, writes: bool = False) -> Moves:
    """Return transfers or long writes to the given and other addresses, some incomplete, with irregular edges."""
    draw, moves = Random(seed), []
    at, levels = 3_000_000, {"SCL": 1, "SDA": 1}

    def move(line: str, level: int, pause: int) -> None:
        nonlocal at
        at += pause
        if levels[line] != level:
            levels[line] = level
            moves.append((at, {line: level}))
        if draw.random() < 0.02:  # a pulse; the other line may change in it
            other = draw.choice(BUS)
            moves.append((at := at + draw.randint(1, 700), {other: 1 - levels[other]}))
            inside = BUS[1 - BUS.index(other)]
            if draw.random() < 0.5:
                levels[inside] = 1 - levels[inside]
                moves.append((at := at + draw.randint(1, 200), {inside: levels[inside]}))
            moves.append((at := at + draw.randint(1, 700), {other: levels[other]}))

    def bit(level: int) -> None:
        hold = draw.choice((1, 300, 900, 3_000))
        move("SDA", level, hold)
        move("SCL", 1, half - hold)
        move("SCL", 0, half)

    def transfer(address: int) -> None:
        """Add a pointer with bytes written after it or read after a repeated START, or a part of that."""
        count = draw.randint(1, 6)
        data = [(0, draw.choice((0, 2, 0x80)))] if draw.random() < 0.8 else [(1, 0xFF)] * count
        parts = [data, [(1, 0xFF)] * count] if draw.random() < 0.7 else [data]
        if writes:
            parts = [[(0, 0xC3)] * 6]
        for part in parts:
            move("SDA", 1, draw.choice((400, 2_000)))
            move("SCL", 1, half)
            move("SDA", 0, half)
            move("SCL", 0, half)
            for number, (reads, byte) in enumerate([(0, address << 1 | part[0][0]), *part]):
                for place in range(7, -1, -1):
                    if draw.random() < 0.001:
                        break
                    bit(byte >> place & 1)
                bit(0 if reads and number < len(part) else 1)
        move("SDA", 0, 900)
        move("SCL", 1, half)
        move("SDA", 1, half)

    turn = 0
    while at < end:
        own = draw.random() < 0.8
        transfer(addresses[turn % len(addresses)] if own else draw.choice((0, 0x22, 0x7A)))
        turn += own
        at += draw.choice((half, 20 * half, 200_000))
    together: dict[int, dict[str, int]] = {}
    for tick, line in moves:
        together.setdefault(tick, {}).update(line)
    return sorted(together.items())


def stepped(
    name: str, moves: Moves, end: int, *, finely: bool, recorded: bool = True, done: Sequence[int] = ()
) -> tuple[list[object], int, int]:
    """Return the records, the number of pin changes, and the number of steps of time.

    finely: step to each applied change as well as to `next_output`.
    """
    records = Records()
    steps = moved = 0
    filtered = {"settings": REGISTERS, **FILTERS[name][0]} if name in FILTERS else {}
    of = CASES[name]() if name in CASES else case("register_slave", dsp=filtered)
    programs = {"dsp": PROGRAMS[name]()} if name in PROGRAMS else None
    with Session(of, BUS, subscribe=records.subscribe if recorded else None, programs=programs) as session:
        for at, levels in [*moves, (end, {})]:
            due = session.next_output()
            while due is not None and due < at:
                assert session.advance(due) == []
                moved += len(session.advance(due + 1))
                steps += 1
                due = session.next_output()
            if finely:
                assert session.advance(at) == []
            session.apply(at, levels)
            if (finely and at < end) or at in done:
                moved += len(session.advance(at + 1))
        session.advance(end)
        session.finish()
    return [tuple(record) for record in records.kept], moved, steps


@pytest.mark.parametrize("seed", range(1, 12) if explores() else [1])
@pytest.mark.parametrize("half", [15_000, 3_750])  # half a period, at 100 and 400 kHz
@pytest.mark.parametrize("name", CASES)
def test_no_pin_changes_before_next_output_and_stepping_to_it_gives_all_changes(
    name: str, half: int, seed: int
) -> None:
    addresses = (0x68, 0x53, 0x1E) if "frames" in name else (0x50,)
    moves = traffic(
        addresses,
        seed,
        3_000_000 + (9_000 if explores() else 150 if name in PROGRAMS else 900) * half,
        half,
        "reader" in name,
    )
    end = moves[-1][0] + 100_000
    lazily, moved, steps = stepped(name, moves, end, finely=False)
    finely, again, _ = stepped(name, moves, end, finely=True)
    assert lazily == finely and moved == again > 0
    if "pin" in name:  # without records, the pads of GPIO have other events
        assert stepped(name, moves, end, finely="synchronised" in name, recorded=False)[1] == moved
    assert all(one[0] < other[0] for one, other in pairwise(moves))
    assert moved <= steps < MOST_STEPS.get(name, 20 if name in PROGRAMS else 4) * len(moves)


def put_byte(moves: Moves, at: int, half: int, value: int, sda: int) -> int:
    """Append the bits of a byte and a released bit after a fall of SCL at `at`; return the last fall of SCL.

    sda: the level of SDA before.
    """
    for place in range(8, -1, -1):
        level = (value << 1 | 1) >> place & 1
        if level != sda:
            moves.append((at + 900, {"SDA": level}))
            sda = level
        moves += [(at + half, {"SCL": 1}), (at + 2 * half, {"SCL": 0})]
        at += 2 * half
    return at


def written(*values: int) -> Moves:
    """Return START, these bytes with a released bit after each, and STOP, at 100 kHz."""
    half, at, sda = 15_000, 3_000_000, 0
    moves: Moves = [(at, {"SDA": 0}), (at + half, {"SCL": 0})]
    at += half
    for value in values:
        at = put_byte(moves, at, half, value, sda)
        sda = 1
    return [*moves, (at + 900, {"SDA": 0}), (at + half, {"SCL": 1}), (at + 2 * half, {"SDA": 1})]


@pytest.mark.parametrize(
    ("name", "address", "moved", "lazily", "finely"),
    [
        ("interrupts", 0x50, 6, 102, 102),
        ("polling", 0x50, 6, 71, 70),
        ("polling", 0x51, 0, 31, 31),
        ("slow reader", 0x50, 6, 63, 63),
        ("slow reader behind synchronised pins", 0x50, 6, 115, 168),
    ],
)
def test_a_transfer_takes_few_steps(name: str, address: int, moved: int, lazily: int, finely: int) -> None:
    moves = written(address << 1, 0x02, 0xC3)
    end = moves[-1][0] + 100_000
    assert stepped(name, moves, end, finely=False)[1:] == (moved, lazily)
    assert stepped(name, moves, end, finely=True)[1:] == (moved, finely)


def test_a_pin_of_an_sci_changes_at_next_output() -> None:
    """A byte is sent on RX and another one answers on TX: 0x59 is sent as 0 1001 1010 1."""
    found = []
    for finely in (False, True):
        session, line, _ = echo()
        with session:
            line.write(bytes([0x58]))  # the byte waits, so its edges are not applied yet
            moved: list[Change] = []
            end = session.now + session.ticks("300 us")
            for at in range(session.now, end, session.ticks("7 us")) if finely else (end,):
                while (due := session.next_output()) is not None and due < at:
                    assert session.advance(due) == []
                    moved += session.advance(due + 1)
                assert session.advance(at) == []
            found.append(moved)
    assert found[0] == found[1] and [change.level for change in found[0]] == [0, 1] * 4 and found[0][0].line == "TX"


def test_a_returned_list_of_changes_is_not_modified_later() -> None:
    """This includes an empty one, which does not grow with later changes."""
    moves = written(0x50 << 1)
    with Session(CASES["polling"](), BUS) as session:
        before = session.advance(1)
        for at, levels in moves:
            session.apply(at, levels)
        assert session.advance(moves[-1][0]) and before == []


@pytest.mark.parametrize(
    "party",
    [
        {"fault": [{"kind": "hold", "wire": "SDA", "at": "0 s", "length": "10 us"}]},
        {
            "controller": {
                "rate": "100 kHz",
                "period": "20 ms",
                "first": "0 s",
                "beside_outside": True,
                "request": [{"address": 0x50, "count": 1}],
            }
        },
    ],
    ids=["fault", "controller"],
)
def test_next_output_predicts_a_change_at_the_first_tick(party: dict[str, Any]) -> None:
    with Session(case(**party), BUS) as session:
        assert session.next_output() == 0
        assert session.advance(1) == [Change(0, "SDA", 0)]
        due = session.next_output()
        assert due is not None and session.advance(due) == []


def test_there_is_no_next_output_if_no_pin_can_change() -> None:
    ended = Firmware("ended", lambda dsp, settings: None, None)
    with Session(case(modules=("I2C-A",)), BUS, programs={"dsp": ended}) as session:
        session.advance(session.ticks("1 ms"))
        assert session.next_output() is None
        session.finish()
        refuses("the session is finished", session.next_output)


Pulses = list[tuple[int, int, int]]

FILTERS: dict[str, tuple[dict[str, Any], Pulses]] = {  # keys of a unit, and pulses close to the limits of the filter
    "of 15 cycles": ({}, [(1, 299, 1), (0, 299, 298), (10, 290, 20), (1, 300, 1), (3, 400, 20), (7, 100, 50)]),
    "of 15 cycles of a slow crystal": ({"ppm": -4500}, [(115, 301, 1), (0, 400, 20)]),
    "of 15 cycles, behind a synchroniser": (
        {"modules": ["I2C-A", "GPIO"]},
        [(0, 299, 1), (1, 299, 10), (10, 290, 289), (0, 300, 150)],
    ),
    "of no cycle": (
        {"options": {"i2c": {"noise_filter_cycles": 0}}},
        [(1, 18, 2), (6, 8, 1), (5, 12, 11), (0, 20, 1), (1, 20, 5)],
    ),
    "that takes edges together": (
        {"options": {"i2c": {"unequal_arrival": "one_sample"}}},
        [(7, 516, 258), (9, 466, 257), (2, 386, 193), (4, 433, 216), (3, 700, 20)],
    ),
}


def starts_in_pulses(pulses: Pulses) -> tuple[Moves, list[int]]:
    """Return for each pulse a START to another address, SCL low for a pulse in which SDA falls, and the own address.

    The begin times of the pulses are returned too.

    pulses: ticks from a multiple of 20 to the pulse, its length, and the ticks from its begin to the fall of SDA.
    """
    moves: Moves = []
    begins = []
    at, half = 3_000_000, 3_750
    for behind, width, fall in pulses:
        moves += [(at, {"SDA": 0}), (at + half, {"SCL": 0})]
        at = put_byte(moves, at + half, half, 0x22 << 1, 0)
        begin = (at + 2 * half) // 20 * 20 + behind
        begins.append(begin)
        moves += [(at + half, {"SCL": 1}), (begin, {"SCL": 0}), (begin + fall, {"SDA": 0}), (begin + width, {"SCL": 1})]
        moves.append((begin + width + half, {"SCL": 0}))
        at = put_byte(moves, begin + width + half, half, 0x50 << 1, 0)
        moves += [(at + 900, {"SDA": 0}), (at + half, {"SCL": 1}), (at + 2 * half, {"SDA": 1})]
        at += 6 * half
    return moves, begins


@pytest.mark.parametrize("done", [False, True])
@pytest.mark.parametrize("name", FILTERS)
def test_a_start_in_a_pulse_shorter_than_a_filter_is_answered(name: str, done: bool) -> None:
    pulses = FILTERS[name][1]
    moves, begins = starts_in_pulses(pulses)
    end = moves[-1][0] + 100_000
    lazily, moved, _ = stepped(name, moves, end, finely=False, done=begins if done else ())
    finely, again, _ = stepped(name, moves, end, finely=True)
    assert lazily == finely and moved == again
    assert 0 < moved < 2 * len(pulses)  # an ACK for each, except for a pulse that passes the filter


def leaves(how: str) -> Firmware:
    """Return a slave that drives SDA low for zeros, and after 133 us releases it by a reset of its module."""

    def main(dsp: Any, settings: Any) -> None:
        i2c, timer = dsp.module("I2C-A"), dsp.module("TIMER0")
        start_i2c(dsp, 0x50)
        i2c.I2CMDR.all = 0x0020  # IRS
        i2c.I2CDXR.all = 0

        def leave() -> None:
            i2c.I2CMDR.all = 0

        if how == "in an interrupt":
            timer.PRD.all = 20_000
            timer.TCR.all = 0x4020
            start_pie(dsp, {"TINT0": leave})
            dsp.compute(19_900)
            while True:
                dsp.compute(3)
        dsp.compute(20_000)
        if how == "behind another write":
            i2c.I2CIER.all = 0
        elif how == "behind a read that waits for a write":
            i2c.I2CIER.all = 0
            i2c.I2CSTR.all  # noqa: B018
        elif how == "by a field":
            i2c.I2CMDR.IRS = 0
        leave()

    return Firmware("leaves", main, None)


@pytest.mark.parametrize("lands", [2, 4])
@pytest.mark.parametrize(
    "how",
    ["at once", "behind another write", "behind a read that waits for a write", "by a field", "in an interrupt"],
)
def test_next_output_predicts_a_pin_change_by_a_register_write_exactly(how: str, lands: int) -> None:
    unit = {"firmware": str(FIRMWARE / "responder.py"), "modules": ["I2C-A", "TIMER0"]}
    options = {"options": {"system": {"write_lands": lands}}}
    with Session(case(unit={"dsp": unit | options}), BUS, programs={"dsp": leaves(how)}) as session:
        at, half = 60_000, 3_750
        session.advance(at)
        session.apply(at, {"SDA": 0})
        for place in range(8, -1, -1):
            session.apply(at + half, {"SCL": 0})
            session.apply(at + half + 900, {"SDA": (0x50 << 2 | 0b11) >> place & 1})
            session.apply(at := at + 2 * half, {"SCL": 1})
        session.apply(at + half, {"SCL": 0})
        session.advance(at + 3 * half)
        assert session.pulls("SDA") and not session.pulls("SCL")
        moved: list[Change] = []
        while not moved:
            due = session.next_output()
            assert due is not None and session.advance(due) == []
            moved = session.advance(due + 1)
        assert moved == [Change(due, "SDA", 1)]


@pytest.mark.parametrize("seed", range(4))
def test_changes_may_be_applied_in_any_order_before_time_advances(seed: int) -> None:
    moves = traffic((0x50,), seed, 3_400_000, 3_750)
    given = []
    for order in (moves, Random(seed).sample(moves, len(moves))):
        with Session(CASES["interrupts"](), BUS) as session:
            session.advance(3_000_000)
            for at, levels in order:
                session.apply(at, levels)
            found: list[object] = []
            due = session.next_output()
            while due is not None and due < moves[-1][0]:
                found += [due, *session.advance(due), *session.advance(due + 1)]
                due = session.next_output()
            given.append(found)
    assert given[0] == given[1]
    assert sum(isinstance(one, Change) for one in given[0]) > 2

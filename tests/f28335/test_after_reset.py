"""After XRS a chip is as new, whatever it was doing: the same story then shows the same, cycle by cycle.

The chip under test is used, reset, and set up again beside one that was never used.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from periph_sim.core.options import Value
from periph_sim.f28335.i2c.module import I2c
from periph_sim.f28335.i2c.register_map import I2C_MAP
from periph_sim.f28335.sci.module import Sci
from periph_sim.f28335.sci.register_map import SCI_MAP

from .i2c_registers import DLB, FFEN, FFIENA, FFRST, IRS, MST, NACKMOD, STT, TRX, XA
from .i2c_rig import BIT, OTHER, OWN, Rig
from .sci_rig import SciRig, frame

# I2C --------------------------------------------------------------------------------------------------


def addressed_to_read(rig: Rig) -> None:
    """Stretching: nothing to send."""
    rig.begin()
    rig.address(OWN, 1)
    rig.wait(BIT)


def two_bytes_unread(rig: Rig) -> None:
    """Stretching: no room."""
    rig.begin(NACKMOD)
    rig.write("I2CMDR", IRS)
    rig.address()
    rig.send(0x11)
    rig.send(0x22)


def fifos_in_use(rig: Rig) -> None:
    rig.set_fifos(FFEN | FFRST | FFIENA | 4, FFRST | FFIENA | 1)
    rig.begin()
    for byte in range(5):
        rig.write("I2CDXR", byte)
    rig.address()
    rig.send(0x11)


def all_codes_waiting(rig: Rig) -> None:
    rig.begin()
    rig.write("I2CIER", 0x7F)
    rig.address()
    rig.send(0x11)
    rig.stop()
    rig.write("I2CISRC", 0xF00)


def as_master(rig: Rig) -> None:
    rig.begin()
    rig.write_other(3)
    rig.wait(5 * BIT)


def in_loop_back(rig: Rig) -> None:
    rig.begin()
    rig.write("I2CDXR", 0x77)
    rig.write("I2CMDR", IRS | MST | TRX | STT | DLB)
    rig.wait(7 * BIT)


def ten_bit_selected(rig: Rig) -> None:
    rig.begin(XA, 0x2C5)
    rig.start()
    rig.send(0xF4)
    rig.send(0xC5)


def halted_as_slave(rig: Rig) -> None:
    rig.begin()
    rig.address()
    rig.wait(20)
    rig.chip.suspend(rig.now, True)
    rig.send(0x11)
    rig.wait(20)
    assert rig.stretching


def halted_as_master(rig: Rig) -> None:
    as_master(rig)
    rig.chip.suspend(rig.now, True)
    rig.wait(2 * BIT)


def emdr_and_prescaler(rig: Rig) -> None:
    rig.write("I2CEMDR", 0)
    rig.write("I2CPSC", 255)
    rig.begin()
    rig.wait(20)


USED: list[Callable[[Rig], None]] = [
    addressed_to_read,
    two_bytes_unread,
    fifos_in_use,
    all_codes_waiting,
    as_master,
    in_loop_back,
    ten_bit_selected,
    halted_as_slave,
    halted_as_master,
    emdr_and_prescaler,
]


def story(rig: Rig) -> None:
    """Written to, read, spoken to by others, and master: with all interrupts on."""
    rig.begin()
    rig.write("I2CIER", 0x7F)
    rig.address()
    rig.send(0x35)
    rig.restart()
    rig.send_bits(OWN << 1 | 1)
    rig.write("I2CDXR", 0xA5)
    rig.acked()
    rig.take(ack=False)
    rig.stop()
    rig.address(OTHER)
    rig.send(0x12)
    rig.stop()
    rig.read("I2CDRR")
    for _ in range(7):
        rig.read("I2CISRC")
    rig.write("I2CSAR", OTHER)
    rig.write("I2CDXR", 0x77)
    rig.write("I2CMDR", IRS | MST | TRX | STT)
    rig.wait(14 * BIT)


def seen(rig: Rig, tell: Callable[[Rig], None]) -> list[tuple[object, ...]]:
    """What a story shows from now on: outputs and registers after every input, requests, notes; times from here."""
    begin, found = rig.now, []
    rig.interrupts.clear()
    rig.chip.notes.clear()
    settle = rig.settle

    def watching() -> None:
        settle()
        registers = [rig.chip.peek(rig.now, register.offset) for register in I2C_MAP]
        found.append((rig.now - begin, rig.chip.out, rig.chip.held, *registers))

    rig.settle = watching  # type: ignore[method-assign]
    tell(rig)
    found += [(cycle - begin, lines) for cycle, lines in rig.interrupts]
    return [*found, *rig.chip.notes]


@pytest.mark.parametrize("use", USED)
def test_i2c(use: Callable[[Rig], None]):
    options: dict[str, Value] = {"noise_filter_cycles": 1, "oar_latch": "at_irs", "int_line": "level"}
    used, fresh = Rig(**options), Rig(**options)
    fresh.chip = I2c(fresh.chip.options)  # without any access
    fresh.chips = [fresh.chip]
    use(used)
    used.chip.reset(used.now)
    used.settle()
    assert used.released and used.chip.held == 0 and used.chip.filter_width == 1
    used.put(scl=1, sda=1)
    used.interrupts.clear()
    used.wait(BIT)
    for rig in (used, fresh):
        rig.set_up()
    assert seen(used, story) == seen(fresh, story)


# SCI --------------------------------------------------------------------------------------------------


def mid_frames(rig: SciRig) -> None:
    for word in (0x11, 0x22, 0x33):
        rig.write("SCITXBUF", word)
    rig.send("0 110")


def overflown(rig: SciRig) -> None:
    for word in range(18):
        rig.send(frame(word, bad="stop" if word == 5 else ""))
    rig.send("0 1")


def after_a_break(rig: SciRig) -> None:
    rig.send("0" * 25)


def asleep(rig: SciRig) -> None:
    rig.set(SLEEP=1, TXWAKE=1)
    rig.send("1" * 12 + frame(0x11))


def halted(rig: SciRig) -> None:
    rig.set(SOFT=1)
    rig.write("SCITXBUF", 0x11)
    rig.send("0 110")
    rig.chip.suspend(rig.now, True)


def looped(rig: SciRig) -> None:
    rig.set(LOOPBKENA=1, FFTXDLY=5)
    rig.write("SCITXBUF", 0x11)
    rig.write("SCITXBUF", 0x22)
    rig.wait(3)


def measuring_a_rate(rig: SciRig) -> None:
    rig.set(CDC=1)
    rig.send("0 1 0 0")


def rate_measured(rig: SciRig) -> None:
    rig.set(CDC=1)
    rig.send(frame(ord("A")) + "11")


def about_to_ask(rig: SciRig) -> None:
    """RXRDY has risen, RXINT is on its way for three more cycles."""
    rig.set(RXBKINTENA=1, SCIFFENA=0)
    rig.send("0 11010010")
    rig.drive(rig.now, "RXD", 1)
    rig.run_until(rig.chip.next_wake)
    assert rig.get("RXRDY") and not rig.count("RXINT")


def sci_story(rig: SciRig) -> None:
    rig.set(PARITYENA=1, PARITY=1, SCICHAR=7)
    rig.set(RXENA=1, TXENA=1, SWRESET=1, RXERRINTENA=1)
    rig.set(RXBKINTENA=1, TXINTENA=1)
    rig.send("1" * 11 + frame(0x4B, parity="even"), at=rig.now + 7)
    rig.write("SCITXBUF", 0x96)
    rig.wait(2)
    rig.write("SCITXBUF", 0x69)
    rig.send(frame(0x11, parity="even") + "1", at=rig.now + 7)
    rig.read("SCIRXBUF")
    rig.set(SCIFFENA=1, TXFFIENA=1, RXFFIENA=1)
    for word in (1, 2, 3):
        rig.write("SCITXBUF", word)
    rig.send(frame(0x22, parity="even") + "1" * 40, at=rig.now + 7)


def sci_seen(rig: SciRig) -> list[tuple[object, ...]]:
    begin, found = rig.now, []
    edges, asked = len(rig.edges), {line: len(rig.asked[line]) for line in ("RXINT", "TXINT")}
    rig.chip.notes.clear()
    look = rig.look

    def looking() -> None:
        look()
        found.append((rig.now - begin, *(rig.peek(register.name) for register in SCI_MAP)))

    rig.look = looking  # type: ignore[method-assign]
    sci_story(rig)
    found += [(time - begin, level) for time, level in rig.edges[edges:]]
    found += [(line, time - begin) for line, before in asked.items() for time in rig.asked[line][before:]]
    return [*found, *rig.chip.notes]


@pytest.mark.parametrize(
    "use",
    [
        mid_frames,
        overflown,
        after_a_break,
        asleep,
        halted,
        looped,
        measuring_a_rate,
        rate_measured,
        about_to_ask,
    ],
)
def test_sci(use: Callable[[SciRig], None]):
    used, fresh = SciRig(fifo=True, RXFFIENA=1), SciRig(raw=True)
    fresh.chip = Sci()  # without any access
    use(used)
    used.rxd(used.now + 1, 1)
    used.run_until(used.now + 4 - used.now % 4)  # on an edge of LSPCLK
    asked = {line: used.count(line) for line in used.asked}
    used.chip.reset(used.now)
    used.look()
    assert used.chip.out == 1
    assert {line: used.count(line) for line in used.asked} == asked
    for rig in (used, fresh):
        rig.run_until(rig.now + 1600 - rig.now % 4)
        rig.chip.gate(rig.now, True)
        rig.set_brr(24)
    assert sci_seen(used) == sci_seen(fresh)


def test_sci_clock_begins_as_that_of_a_new_module():
    """Both are given their clock in cycle 40000 and send at once, with BRR as the reset leaves it."""
    used = SciRig(brr=200)
    mid_frames(used)
    used.run_until(40_000)
    used.chip.reset(40_000)
    told: list[list[tuple[int, int]]] = []
    for chip in (used.chip, Sci()):
        chip.gate(40_000, True)
        chip.write(40_000, SCI_MAP["SCICTL1"].offset, 0x22)
        chip.write(40_000, SCI_MAP["SCITXBUF"].offset, 0)
        moved, level = [], chip.out
        while chip.next_wake < 50_000:
            now = chip.next_wake
            chip.wake(now)
            if chip.out != level:
                level = chip.out
                moved.append((now, level))
        told.append(moved)
    assert told == [[(40_008, 0), (40_136, 1)]] * 2  # the start bit and one data bit, of eight times eight cycles each

"""A complete unit: the addresses of its modules, and how modules follow clocks and gates that firmware changes."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import pytest

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.sampler import watch
from periph_sim.core.time import Timebase
from periph_sim.core.wire import Wire
from periph_sim.f28335.parts.f28335 import PART
from periph_sim.f28335.sci.register_map import SCI_MAP
from periph_sim.firmware import start_i2c, start_pie, start_sci
from periph_sim.processor.dsp import Dsp, DspPlan
from periph_sim.processor.user_code import FirmwareError, Misuse
from tests.processor import bench

# First and last address of each module (the register maps of the manuals).
FRAMES = """
    PIE   0CE0 0CFF   TIMER0 0C00 0C07   TIMER1 0C08 0C0F   TIMER2 0C10 0C17   GPIO 6F80 6FFF   SYS 7010 702F
    SCI-A 7050 705F   SCI-B  7750 775F   SCI-C  7770 777F   I2C-A  7900 793F   XINT 7070 707F
    SPI-A 7040 704F
"""


def unit(*modules: str, low: frozenset[int] = frozenset(), **wires: int) -> tuple[Dsp, Kernel, dict[str, Wire]]:
    """Return a unit with wires, given by name and GPIO number, its kernel and the wires.

    low: pads that a resistor pulls down.
    """
    kernel, recorder = Kernel(), Recorder()
    made = {name: Wire(kernel, name, recorder) for name in wires}
    plan = DspPlan("dsp", modules, {pin: made[name] for name, pin in wires.items()}, pulled_down=low)
    return Dsp(kernel, Timebase(150_000_000), recorder, plan), kernel, made


def run(dsp: Dsp, kernel: Kernel, firmware: Callable[[], None]) -> None:
    dsp.start(firmware)
    kernel.run_until(kernel.now + 2_000_000)
    assert dsp.cpu.program.finished


def test_every_module_has_the_address_range_of_the_manual():
    memory = unit(*PART.selectable)[0].memory
    words = FRAMES.split()
    manual = {name: (int(first, 16), int(last, 16)) for name, first, last in zip(*[iter(words)] * 3, strict=True)}
    assert {name: (place.base, place.base + place.size - 1) for name, place in memory.places.items()} == manual
    assert memory.at(0x7000) is None
    assert str(memory.refusal(0x7000)).startswith("0x7000 belongs to no module")


def test_a_module_whose_clock_is_disabled_again_ignores_writes():
    dsp, kernel, _ = unit("SCI-A")
    seen: list[int] = []

    def main() -> None:
        clocks, sci = dsp.module("SYS"), dsp.module("SCI-A")
        dsp.eallow()
        for on, value in ((1, 0x11), (0, 0x22)):
            clocks.PCLKCR0.SCIAENCLK = on
            dsp.compute(10)
            sci.SCILBAUD.all = value
        clocks.PCLKCR0.SCIAENCLK = 1
        dsp.compute(10)
        seen.append(sci.SCILBAUD.all)

    run(dsp, kernel, main)
    assert seen == [0x11]
    assert "sci.clock_gate_access" in dsp.touched


@pytest.mark.parametrize(
    ("module", "enable", "register"),
    [("SCI-A", "SCIAENCLK", "SCILBAUD"), ("I2C-A", "I2CAENCLK", "I2COAR")],
)
def test_without_its_clock_a_module_reads_0(module: str, enable: str, register: str):
    dsp, kernel, _ = unit(module)
    seen: list[int] = []

    def main() -> None:
        clocks, place = dsp.module("SYS"), dsp.module(module)
        dsp.eallow()
        for on in (1, 0, 1):
            setattr(clocks.PCLKCR0, enable, on)
            dsp.compute(10)
            if not seen:
                getattr(place, register).all = 0x11
                dsp.compute(10)
            seen.append(getattr(place, register).all)

    run(dsp, kernel, main)
    assert seen == [0x11, 0, 0x11]
    assert "clock_gate_access" in dsp.sockets[module].chip.touched


@pytest.mark.parametrize("skip", [False, True])
def test_without_clock_a_wait_reads_0_and_a_debugger_sees_the_value_of_the_register(skip: bool):
    """The timer's routine stops and restarts the module's clock; firmware waits to read 0 and then the value."""
    dsp, kernel = bench.unit("SCI-A", "TIMER0", skip_polls=skip)
    log: list[tuple[str, int]] = []

    def tick() -> None:
        clocks = dsp.module("SYS")
        dsp.eallow()
        clocks.PCLKCR0.SCIAENCLK = 1 - clocks.PCLKCR0.SCIAENCLK
        dsp.edis()
        log.append(("held", dsp.sockets["SCI-A"].peek(dsp.cpu.cycle, SCI_MAP["SCILBAUD"].offset)))
        dsp.module("PIE").PIEACK.all = 1

    def main() -> None:
        clocks, sci, timer = dsp.module("SYS"), dsp.module("SCI-A"), dsp.module("TIMER0")
        dsp.eallow()
        clocks.PCLKCR0.SCIAENCLK = 1
        dsp.compute(10)
        sci.SCILBAUD.all = 0x11
        timer.TCR.TSS = 1
        timer.PRD.all = 3000
        start_pie(dsp, {"TINT0": tick})
        timer.TCR.all = 0x4020  # TIE, TRB
        dsp.spin(lambda: sci.SCILBAUD.all == 0)
        log.append(("gone", dsp.cpu.cycle))
        dsp.spin(lambda: sci.SCILBAUD.all == 0x11)
        log.append(("back", dsp.cpu.cycle))

    run(dsp, kernel, main)
    assert [what for what, _ in log[:4]] == ["held", "gone", "held", "back"]
    held, gone, still, back = (value for _, value in log[:4])
    assert held == still == 0x11
    assert 2900 < back - gone < 3100
    assert "sci.clock_gate_access" in dsp.touched


def test_an_interrupt_that_is_pending_at_the_start_up_is_taken_once():
    """RXFFIL is 0 after reset, so RXFFINT is set before RXFFIENA is."""
    dsp, kernel, _ = unit("SCI-B")
    entered: list[int] = []

    def main() -> None:
        sci, pie = start_sci(dsp, "SCI-B"), dsp.module("PIE")

        def received() -> None:
            entered.append(dsp.cpu.cycle)
            sci.SCIFFRX.RXFFINTCLR = 1
            pie.PIEACK.all = 0x100

        sci.SCIFFRX.RXFFIL = 1
        sci.SCIFFRX.RXFFIENA = 1
        start_pie(dsp, {"SCIRXINTB": received})
        dsp.compute(1000)

    run(dsp, kernel, main)
    assert len(entered) == 1


@pytest.mark.parametrize(("timer", "name"), [("TIMER0", "TINT0"), ("TIMER1", "INT13"), ("TIMER2", "INT14")])
def test_start_pie_enables_an_interrupt_in_a_group_of_the_pie_or_outside_of_them(timer: str, name: str):
    dsp, kernel, _ = unit(timer)
    entered: list[int] = []

    def served() -> None:
        entered.append(dsp.cpu.cycle)
        dsp.module("PIE").PIEACK.all = 1

    def main() -> None:
        dsp.module(timer).PRD.all = 999
        start_pie(dsp, {name: served})
        dsp.module(timer).TCR.all = 0x4020  # TIE, TRB
        dsp.compute(3500)

    run(dsp, kernel, main)
    assert [later - cycle for cycle, later in pairwise(entered)][:2] == [1000, 1000]


def test_start_pie_refuses_an_interrupt_without_a_bit_in_ier():
    dsp, kernel, _ = unit()
    dsp.start(lambda: start_pie(dsp, {"NMI": lambda: None}))
    with pytest.raises(FirmwareError, match="18 does not name a CPU interrupt; expected a number from 1 to 16"):
        kernel.run_until(1000)


def test_pieack_after_pieier_causes_a_second_request_and_the_error_explains_it():
    dsp, kernel, _ = unit("SCI-B")

    def main() -> None:
        sci, pie = start_sci(dsp, "SCI-B"), dsp.module("PIE")

        def received() -> None:
            sci.SCIFFRX.RXFFINTCLR = 1
            pie.PIEACK.all = 0x100

        sci.SCIFFRX.RXFFIL = 1
        sci.SCIFFRX.RXFFIENA = 1
        dsp.handle("SCIRXINTB", received)
        pie.PIECTRL.ENPIE = 1
        pie.PIEIER9.INTx3 = 1
        pie.PIEACK.all = 0x100
        dsp.enable_interrupt(9)
        dsp.eint()
        dsp.compute(1000)

    with pytest.raises(
        FirmwareError, match=r"SCIRXINTA was taken .*; it has SCIRXINTB\. No line of its group was both"
    ):
        run(dsp, kernel, main)


def test_the_sci_follows_lspclk_when_it_is_changed_and_changed_back():
    """The start bit and one data bit of 0: with BRR = 0, TXD is low for 16 SCICLK of two LSPCLK each."""
    dsp, kernel, wires = unit("SCI-A", TXD=29)
    low: list[int] = []
    watch([wires["TXD"]], lambda tick, level: low.append(dsp.clock.cycle_at(tick)))

    def main() -> None:
        clocks, sci = dsp.module("SYS"), dsp.module("SCI-A")
        dsp.eallow()
        clocks.PCLKCR0.SCIAENCLK = 1
        dsp.compute(10)
        sci.SCICTL1.all = 0x22
        for lospcp in (2, 1, 2):
            clocks.LOSPCP.all = lospcp
            dsp.compute(10)
            sci.SCITXBUF.all = 0
            dsp.compute(500)

    run(dsp, kernel, main)
    assert [rise - fall for fall, rise in zip(low[::2], low[1::2], strict=True)] == [16 * 2 * n for n in (4, 2, 4)]


def test_the_statement_of_a_lost_word_is_the_write_and_not_the_one_at_its_landing():
    """TXSHF takes the first character and SCITXBUF the second; the third is lost while the next statement runs."""
    dsp, kernel, _ = unit("SCI-A")

    def main() -> None:
        clocks, sci = dsp.module("SYS"), dsp.module("SCI-A")
        dsp.eallow()
        clocks.PCLKCR0.SCIAENCLK = 1
        dsp.compute(10)
        sci.SCICTL1.all = 0x22
        for _ in range(2):
            sci.SCITXBUF.all = 0
            dsp.compute(50)
        sci.SCITXBUF.TXDT = 0
        dsp.compute(50)

    run(dsp, kernel, main)
    (count,) = dsp.lost_counts.values()
    (place,) = dsp.note_places.values()
    assert (count, place.line - main.__code__.co_firstlineno) == (1, 9)


def test_a_reset_resets_all_modules_before_any_sees_the_slower_clock():
    """I2CPSC = 14 suits 150 MHz; at the 7.5 MHz after the reset it would be noted as wrong."""
    dsp, kernel, _ = unit("I2C-A", SDA=32, SCL=33)

    def main() -> None:
        if not dsp.resets:
            start_i2c(dsp)
            dsp.module("I2C-A").I2CMDR.IRS = 1
            dsp.eallow()
            dsp.module("SYS").WDCR.all = 0  # a wrong value of WDCHK resets the unit

    dsp.start(main)
    kernel.run_until(kernel.now + 2_000_000)
    assert dsp.resets == 1 and dsp.clock.hz < 10_000_000
    assert dsp.sockets["I2C-A"].notes == []


MS = 3_000_000  # ticks of a millisecond


def reset_by_pin(dsp: Dsp, kernel: Kernel, low_at: int, low_for: int) -> None:
    """Pull XRS low for this time, in ticks."""
    pin = (xrs := Wire(kernel, "XRS", dsp.recorder)).attach("fault")
    dsp.connect_reset(xrs)
    kernel.call_at(kernel.now + low_at, lambda: pin.drive(0))
    kernel.call_at(kernel.now + low_at + low_for, lambda: pin.drive(1))


def test_a_unit_whose_reset_pin_is_low_for_long_stays_in_reset_until_its_release():
    """The watchdog, which a reset enables, would overflow after 4.37 ms if it counted."""
    dsp, kernel, _ = unit()
    begun: list[int] = []

    def main() -> None:
        begun.append(kernel.now)
        dsp.compute(10_000_000)

    reset_by_pin(dsp, kernel, low_at=1 * MS, low_for=20 * MS)
    released = kernel.now + 21 * MS
    dsp.start(main)
    kernel.run_until(released)
    assert len(begun) == 1
    kernel.run_until(released + 10 * MS)
    assert len(begun) == 2 and begun[1] > released
    assert (dsp.resets, dsp.watchdog_resets) == (1, [])


def test_modules_count_from_the_release_of_the_reset_pin():
    """Main reads WDCNTR and TIM at once: SYSCLKOUT is 7.5 MHz, and WDCNTR counts every 512 periods of OSCCLK."""
    dsp, kernel = bench.unit("TIMER0", from_boot=True)
    seen: list[tuple[int, bool]] = []

    def main() -> None:
        seen.append((dsp.module("SYS").WDCNTR.all, dsp.module("TIMER0").TIM.all > 0xFFFF - 100))
        dsp.compute(1_000_000)

    reset_by_pin(dsp, kernel, low_at=1 * MS, low_for=1 * MS)
    dsp.start(main)
    kernel.run_until(3 * MS)
    assert seen == [(0, True), (0, True)]


@pytest.mark.parametrize("pin", [-1, 88, 1.0, None])
def test_a_pin_that_the_chip_does_not_have_is_refused(pin: object):
    dsp, *_ = unit("GPIO")
    for call in (dsp.set_pin, dsp.clear_pin):
        with pytest.raises(Misuse, match="does not name a pin; expected a number from 0 to 87"):
            call(pin)


@pytest.mark.parametrize("number", [0, 17, 100, -1, True, None])
def test_an_interrupt_that_the_cpu_does_not_have_is_refused(number: object):
    dsp, *_ = unit()
    with pytest.raises(Misuse, match="does not name a CPU interrupt; expected a number from 1 to 16"):
        dsp.enable_interrupt(number)

"""Mutants that are argued to have no effect on this chip, with their arguments."""

from __future__ import annotations

from typing import NamedTuple

from .changes import DELAYS, Mutant

WITHOUT_EFFECT = "without-effect"


class Argument(NamedTuple):
    """An argument for some mutants.

    why: the reason that no effect is observable.
    mutants: their texts; "N cycles late" stands for each delay.
    rules: the rules of the manuals on which it is based, by number.
    lint: the finding of `lint` for the unchanged statement, if there is one.
    """

    why: str
    mutants: tuple[str, ...]
    rules: tuple[str, ...] = ()
    lint: str = ""


OF_THE_PUBLISHED = (
    Argument(
        "TRX is the direction of a master; a slave takes it from the address",
        (
            "batch_read: exchanged: i2c.I2CMDR.TRX = 1 --> i2c.I2CMDR.TRX = 0",
            "batch_read: moved past i2c.I2CCNT.all = self.settings.count: i2c.I2CMDR.TRX = 1",
        ),
        ("I2C-053",),
        WITHOUT_EFFECT,
    ),
    Argument(
        "I2CCNT does not limit a slave",
        (
            "batch_read: exchanged: i2c.I2CCNT.all = 1 --> i2c.I2CCNT.all = 0",
            "batch_read: moved past i2c.I2CSTR.SCD = 1: i2c.I2CCNT.all = self.settings.count",
        ),
        ("I2C-104", "I2C-128"),
        WITHOUT_EFFECT,
    ),
    Argument(
        "TRX is the direction of a master, so it may also be written before the wait",
        ("batch_read: moved past i2c.I2CMDR.TRX = 1: dsp.spin(lambda: i2c.I2CSTR.RRDY == 1)",),
        ("I2C-053",),
    ),
    Argument(
        "MST is 0 since reset, and TRX is the direction of a master",
        ("slave_config: exchanged: i2c.I2CMDR.MST = 0 --> i2c.I2CMDR.TRX = 0",),
        ("I2C-053", "I2C-335"),
    ),
    Argument(
        "the write of the field writes back all of I2CSTR, so SCD is cleared too; a 1 does not clear XRDY",
        ("batch_read: exchanged: i2c.I2CSTR.SCD = 1 --> i2c.I2CSTR.XRDY = 1",),
        ("I2C-233",),
    ),
    Argument(
        "IRS has been 1 since the own address was set, and STB only affects a master",
        (
            "batch_read: exchanged: i2c.I2CMDR.IRS = 1 --> i2c.I2CMDR.STB = 1",
            "batch_read: moved past if self.settings.mask_during_i2c:: i2c.I2CMDR.IRS = 1",
        ),
        ("I2C-065",),
    ),
    Argument(
        "the returned value is not used",
        ("batch_read: exchanged: return i2c.I2CSTR.NACK --> return i2c.I2CSTR.AL",),
    ),
    Argument(
        "creating an iterator makes no access and takes no time",
        ("batch_read: moved past buffer = endless(data): if self.settings.sdir_wait:",),
    ),
    Argument(
        "the main loop reads frame_waits only after the service routine has ended",
        (
            "sci_received: moved past self.frame_waits = True: if self.settings.frame_cost:",
            "sci_received: moved past sci.SCIFFRX.RXFFOVRCLR = 1: self.frame_waits = True",
        ),
    ),
    Argument(
        "RXFFOVF requests no interrupt and is not read; RXFIFORESET is 1, and a 0 in RXFFOVRCLR has no effect",
        (
            "sci_received: exchanged: sci.SCIFFRX.RXFFOVRCLR = 1 --> sci.SCIFFRX.RXFIFORESET = 1",
            "sci_received: exchanged: sci.SCIFFRX.RXFFOVRCLR = 1 --> sci.SCIFFRX.RXFFOVRCLR = 0",
        ),
        ("SCI-008", "SCI-180"),
    ),
    Argument(
        "each statement clears another flag; the FIFO is empty, so there is no request between them",
        (
            "sci_received: moved past sci.SCIFFRX.RXFFINTCLR = 1: sci.SCIFFRX.RXFFOVRCLR = 1",
            "sci_received: moved past pie.PIEACK.all = 256: sci.SCIFFRX.RXFFINTCLR = 1",
        ),
        ("SCI-175", "SCI-176", "SCI-181", "SYS-101"),
    ),
    Argument(
        "a pin of the models and the I2C module do not depend on each other",
        ("run: moved past start_i2c(dsp): start_pin(dsp, settings.pin)",),
    ),
    Argument(
        "the values depend on the frame and on the number of the sample, not on the instant at which they are computed",
        (
            "model: moved past codes = shown(frame) if self.models is None else self.models.chips(frame): "
            "dsp.compute(self.cost, 'model')",
        ),
    ),
    Argument(
        "an assignment to a variable takes no time",
        (
            "serve_frame_by_frame: moved past first, *others = self.settings.order: dsp, i2c = (self.dsp, self.i2c)",
            "serve_frame_by_frame: moved past self.model(): first, *others = self.settings.order",
            "serve_frame_by_frame: moved past self.slave_config(first): ran = False",
            "serve_frame_by_frame: moved past ran = True: self.model()",
        ),
    ),
)

OF_EACH_INTERRUPT = "for group, line in [dsp.handle(name, handler) for name, handler in handlers.items()]:"

OF_THE_START = (
    Argument(
        "every case of these firmwares has a GPIO module",
        (
            "start_pin: deleted: if not dsp.has('GPIO'):",
            "start_pin: moved past gpio = dsp.module('GPIO'): if not dsp.has('GPIO'):",
            "start_pin: deleted: return",
            "start_pin: N cycles late: return",
        ),
    ),
    Argument(
        "an assignment of a module or a port to a variable takes no time",
        (
            "start_pin: moved past port = 'ABC'[pin // 32]: gpio = dsp.module('GPIO')",
            "start_pin: moved past dsp.clear_pin(pin): port = 'ABC'[pin // 32]",
            "start_i2c: moved past dsp.eallow(): clocks = dsp.module('SYS')",
            "start_i2c: moved past i2c = dsp.module('I2C-A'): dsp.edis()",
            "sci_fifo_receiver: moved past dsp.eallow(): clocks = dsp.module('SYS')",
            "sci_fifo_receiver: moved past sci = dsp.module('SCI-A'): dsp.edis()",
        ),
    ),
    Argument(
        "GPIO data registers are not protected, and the pin is still an input",
        ("start_pin: moved past dsp.eallow(): dsp.clear_pin(pin)",),
        ("SYS-046", "SYS-058"),
    ),
    Argument(
        "the module has its clock before its first access in either order, and its pins can be set without it",
        (
            "start_i2c: moved past if dsp.has('GPIO'):: clocks.PCLKCR0.I2CAENCLK = 1",
            "sci_fifo_receiver: moved past if dsp.has('GPIO'):: clocks.PCLKCR0.SCIAENCLK = 1",
        ),
        ("I2C-008", "SYS-049"),
    ),
    Argument(
        "settings of pins do not depend on each other, and the module that uses the pins is in reset",
        (
            "start_i2c: moved past gpio.GPBQSEL1.GPIO33 = 3: gpio.GPBQSEL1.GPIO32 = 3",
            "start_i2c: moved past gpio.GPBMUX1.GPIO32 = 1: gpio.GPBQSEL1.GPIO33 = 3",
            "start_i2c: moved past gpio.GPBMUX1.GPIO33 = 1: gpio.GPBMUX1.GPIO32 = 1",
            "sci_fifo_receiver: moved past gpio.GPAMUX2.GPIO28 = 1: gpio.GPAQSEL2.GPIO28 = 3",
            "sci_fifo_receiver: moved past gpio.GPAMUX2.GPIO29 = 1: gpio.GPAMUX2.GPIO28 = 1",
        ),
        ("SYS-049", "SYS-050", "I2C-336", "SCI-013"),
    ),
    Argument(
        "SDA synchronised to SYSCLKOUT is at most one cycle late, and still between the same two edges of SCL",
        ("start_i2c: exchanged: gpio.GPBQSEL1.GPIO32 = 3 --> gpio.GPBQSEL1.GPIO33 = 3",),
        ("SYS-067", "SYS-068"),
    ),
    Argument(
        "RX is at most one cycle late if synchronised, and six if qualified by six samples, which is a 200th of a bit",
        (
            "sci_fifo_receiver: exchanged: gpio.GPAQSEL2.GPIO28 = 3 --> gpio.GPAQSEL2.GPIO29 = 3",
            "sci_fifo_receiver: exchanged: gpio.GPAQSEL2.GPIO28 = 3 --> gpio.GPAQSEL2.GPIO28 = 2",
        ),
        ("SYS-067", "SYS-070"),
    ),
    Argument(
        "nothing is sent on TX, and nothing is wired to GPIO30",
        (
            "sci_fifo_receiver: exchanged: gpio.GPAMUX2.GPIO29 = 1 --> gpio.GPAMUX2.GPIO30 = 1",
            "sci_fifo_receiver: exchanged: gpio.GPAMUX2.GPIO29 = 1 --> gpio.GPAMUX2.GPIO29 = 0",
        ),
        ("SYS-049", "SYS-052"),
    ),
    Argument(
        "the registers do not depend on each other, and the module is in reset",
        (
            "start_i2c: moved past i2c.I2COAR.all = own_address: i2c.I2CMDR.all = 0",
            "start_i2c: moved past i2c.I2CPSC.all = 14: i2c.I2COAR.all = own_address",
            "start_i2c: moved past i2c.I2CCLKL.all = 10: i2c.I2CPSC.all = 14",
            "start_i2c: moved past i2c.I2CCLKH.all = 5: i2c.I2CCLKL.all = 10",
            "sci_fifo_receiver: moved past sci.SCICTL1.all = 3: sci.SCICCR.all = sciccr",
            "sci_fifo_receiver: moved past sci.SCICTL2.all = 0: sci.SCICTL1.all = 3",
            "sci_fifo_receiver: moved past sci.SCIHBAUD.all = brr >> 8: sci.SCICTL2.all = 0",
            "sci_fifo_receiver: moved past sci.SCIFFRX.all = 0: sci.SCIFFTX.all = 49152",
        ),
        ("I2C-336", "I2C-337", "SCI-013", "SCI-204"),
    ),
    Argument(
        "the first character begins milliseconds after both statements",
        ("sci_fifo_receiver: moved past sci.SCICTL1.all = 35: sci.SCIFFRX.all = 24672 | level",),
        ("SCI-205", "SCI-207"),
    ),
    Argument(
        "a slave does not generate SCL, so the divisors of a master's clock are not used",
        (
            "start_i2c: exchanged: i2c.I2CCLKL.all = 10 --> i2c.I2CCLKL.all = 8",
            "start_i2c: exchanged: i2c.I2CCLKH.all = 5 --> i2c.I2CCLKH.all = 4",
        ),
        ("I2C-042",),
    ),
    Argument(
        "the module is in reset until the last write to SCICTL1, which also sets RXENA",
        ("sci_fifo_receiver: exchanged: sci.SCICTL1.all = 3 --> sci.SCICTL1.all = 2",),
        ("SCI-013",),
    ),
    Argument(
        "TXINT has no service routine, and its bit of PIEIER is 0",
        ("sci_fifo_receiver: exchanged: sci.SCICTL2.all = 0 --> sci.SCICTL2.all = 1",),
        ("SCI-144", "SCI-161"),
    ),
    Argument(
        "brr is 40 in every case, an even number",
        ("sci_fifo_receiver: exchanged: sci.SCILBAUD.all = brr & 255 --> sci.SCILBAUD.all = brr & 254",),
        ("SCI-079",),
    ),
    Argument(
        "the next write sets all of SCIFFRX; the level matters only when the FIFO is out of reset",
        ("sci_fifo_receiver: exchanged: sci.SCIFFRX.all = 0 --> sci.SCIFFRX.all = 1",),
    ),
    Argument(
        "INTM holds every interrupt until dsp.eint(), which is one of the last two statements of the start-up, and "
        "nothing requests one within it",
        (
            "start_pie: moved past pie.PIEACK.all = 4095: pie.PIECTRL.ENPIE = 1",
            f"start_pie: moved past {OF_EACH_INTERRUPT}: pie.PIEACK.all = 4095",
            "start_pie: moved past dsp.enable_interrupt(group): if line:",
            f"start_pie: moved past dsp.eint(): {OF_EACH_INTERRUPT}",
        ),
        ("SYS-151",),
    ),
    Argument(
        "bit 0 belongs to group 1, of which no interrupt is enabled",
        ("start_pie: exchanged: pie.PIEACK.all = 4095 --> pie.PIEACK.all = 4094",),
        ("SYS-103",),
    ),
)

OF_THE_ROBUST = (
    Argument(
        "the main loop reads the frame only after the service routine has ended",
        (
            "sci_received: moved past if self.settings.frame_cost:: if not any((word & BROKEN for word in words)):",
            "sci_received: moved past self.frame_waits = True: self.frame = bytes((word & 255 for word in words))",
        ),
    ),
    Argument(
        "the FIFO is empty, and the next 12 characters take a millisecond, so there is no request between them",
        (
            "sci_received: moved past sci.SCIFFRX.all = RX_ON | RX_CLEAR | FRAME_BYTES: if self.settings.frame_cost:",
            "sci_received: moved past self.pie.PIEACK.all = GROUP_9: sci.SCIFFRX.all = RX_ON | RX_CLEAR | FRAME_BYTES",
        ),
        ("SCI-175", "SCI-176", "SYS-101"),
    ),
    Argument(
        "receiver and FIFO are in reset until both are released, and RX is idle until then",
        (
            "look_at_line: moved past sci.SCIFFRX.all = FRAME_BYTES: sci.SCICTL1.SWRESET = 0",
            "look_at_line: moved past sci.SCICTL1.SWRESET = 1: sci.SCIFFRX.all = RX_ON | RX_CLEAR | FRAME_BYTES",
        ),
        ("SCI-202", "SCI-205", "SCI-207"),
    ),
    Argument(
        "the next write sets all of SCIFFRX; the level matters only when the FIFO is out of reset",
        ("look_at_line: exchanged: sci.SCIFFRX.all = FRAME_BYTES --> sci.SCIFFRX.all = FRAME_BYTES >> 1",),
    ),
    Argument(
        "fewer than 12 words waited, so RXFFINT is 0; RXFFOVF requests no interrupt and is not read",
        (
            "look_at_line: exchanged: sci.SCIFFRX.all = RX_ON | RX_CLEAR | FRAME_BYTES --> "
            "sci.SCIFFRX.all = RX_ON | RX_ON | FRAME_BYTES",
        ),
        ("SCI-175", "SCI-180"),
    ),
    Argument(
        "an assignment to a variable takes no time",
        (
            "look_at_line: moved past left = 0: sci.SCICTL1.SWRESET = 1",
            "wait_for: moved past def one_of_them() -> bool:: i2c, timer, found = (self.i2c, self.wait_timer, 0)",
            "wait_for_round: moved past frames = self.settings.models_run == 'frame': "
            "i2c, near, late, ran = (self.i2c, self.round_timer, self.wait_timer, False)",
            "wait_for_round: moved past def something_to_do() -> bool:: frames = self.settings.models_run == 'frame'",
            "wait_for_round: moved past self.overdue = 0: near.TCR.all = RELOAD",
            "wait_for_round: moved past ran = True: self.model()",
            "model: moved past dsp.clear_pin(self.settings.pin): "
            "self.data = dict(zip((GYROSCOPE, ACCELEROMETER, MAGNETOMETER), codes, strict=True))",
            "look_at_round: moved past self.overdue = 0: self.round_timer.TCR.all = RELOAD",
        ),
    ),
    Argument(
        "each evaluation of the wait's condition sets found before it is returned",
        (
            "wait_for: exchanged: i2c, timer, found = (self.i2c, self.wait_timer, 0) --> "
            "i2c, timer, found = (self.i2c, self.wait_timer, 1)",
        ),
    ),
    Argument(
        "the module is in reset, and the next write sets all of I2CMDR",
        ("own_address: exchanged: i2c.I2CMDR.all = 0 --> i2c.I2CMDR.all = 1",),
        ("I2C-336",),
    ),
    Argument(
        "FREE only has an effect at a breakpoint",
        ("own_address: exchanged: i2c.I2CMDR.all = FREE | IRS --> i2c.I2CMDR.all = IRS | IRS",),
        ("I2C-324", "I2C-325"),
    ),
    Argument(
        "the two conditions exclude each other, since without any flag there is neither SDIR nor SCD",
        (
            "serve: moved past if found & SDIR:: if not found:",
            "send: moved past if not found:: if found & SCD:",
        ),
    ),
    Argument(
        "without a return statement it returns None, and the caller only tests whether the value is true",
        ("send: deleted: return False",),
    ),
)

ARGUMENTS = (*OF_THE_PUBLISHED, *OF_THE_ROBUST, *OF_THE_START)


def argument_of(mutant: Mutant) -> Argument | None:
    """Return the argument for a mutant, or None if a budget should catch the mutant."""
    return next((one for one in ARGUMENTS if any(means(text, mutant) for text in one.mutants)), None)


def means(text: str, mutant: Mutant) -> bool:
    """True if a text in an argument denotes this mutant."""
    return mutant.text in (text, *(text.replace("N cycles", f"{cycles} cycles") for cycles in DELAYS))

"""Mutants without effect on this chip, argued: a mutant goes in; the argument comes out, or nothing."""

from __future__ import annotations

from typing import NamedTuple

from .changes import DELAYS, Mutant

WITHOUT_EFFECT = "without-effect"


class Argument(NamedTuple):
    """why: nothing can tell. mutants: their texts; "N cycles late" stands for each delay.

    rules: of the manuals, by their numbers. lint: that says of the unchanged statement that it has no effect.
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
        "TRX is the direction of a master: so it may be written before the wait, too",
        ("batch_read: moved past i2c.I2CMDR.TRX = 1: dsp.spin(lambda: i2c.I2CSTR.RRDY == 1)",),
        ("I2C-053",),
    ),
    Argument(
        "MST is 0 since reset, and TRX is the direction of a master",
        ("slave_config: exchanged: i2c.I2CMDR.MST = 0 --> i2c.I2CMDR.TRX = 0",),
        ("I2C-053", "I2C-335"),
    ),
    Argument(
        "the field's write gives back all of I2CSTR, so SCD is cleared with it; XRDY is not cleared by a 1",
        ("batch_read: exchanged: i2c.I2CSTR.SCD = 1 --> i2c.I2CSTR.XRDY = 1",),
        ("I2C-233",),
    ),
    Argument(
        "IRS is 1 there since the own address was set, and STB is a master's",
        (
            "batch_read: exchanged: i2c.I2CMDR.IRS = 1 --> i2c.I2CMDR.STB = 1",
            "batch_read: moved past if self.settings.mask_during_i2c:: i2c.I2CMDR.IRS = 1",
        ),
        ("I2C-065",),
    ),
    Argument(
        "nobody uses what it returns",
        ("batch_read: exchanged: return i2c.I2CSTR.NACK --> return i2c.I2CSTR.AL",),
    ),
    Argument(
        "an iterator is made without an access, and takes no time",
        ("batch_read: moved past buffer = endless(data): if self.settings.sdir_wait:",),
    ),
    Argument(
        "the main loop looks at frame_waits when the service routine is over, and not before",
        (
            "sci_received: moved past self.frame_waits = True: if self.settings.frame_cost:",
            "sci_received: moved past sci.SCIFFRX.RXFFOVRCLR = 1: self.frame_waits = True",
        ),
    ),
    Argument(
        "RXFFOVF asks for no interrupt and nobody reads it; RXFIFORESET is 1, and a 0 in RXFFOVRCLR does nothing",
        (
            "sci_received: exchanged: sci.SCIFFRX.RXFFOVRCLR = 1 --> sci.SCIFFRX.RXFIFORESET = 1",
            "sci_received: exchanged: sci.SCIFFRX.RXFFOVRCLR = 1 --> sci.SCIFFRX.RXFFOVRCLR = 0",
        ),
        ("SCI-008", "SCI-180"),
    ),
    Argument(
        "each clears a flag of its own; the FIFO is empty, so no request comes between them",
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
        "a name for a module or a port takes no time",
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
        "GPIO data registers are not protected, and the pin is an input still",
        ("start_pin: moved past dsp.eallow(): dsp.clear_pin(pin)",),
        ("SYS-046", "SYS-058"),
    ),
    Argument(
        "a module gets its clock before its first access either way; its pins are set without it",
        (
            "start_i2c: moved past if dsp.has('GPIO'):: clocks.PCLKCR0.I2CAENCLK = 1",
            "sci_fifo_receiver: moved past if dsp.has('GPIO'):: clocks.PCLKCR0.SCIAENCLK = 1",
        ),
        ("I2C-008", "SYS-049"),
    ),
    Argument(
        "settings of pins do not depend on each other, and the module that gets them is in reset",
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
        "SDA synchronised to SYSCLKOUT is a cycle late at most, and still between the same two edges of SCL",
        ("start_i2c: exchanged: gpio.GPBQSEL1.GPIO32 = 3 --> gpio.GPBQSEL1.GPIO33 = 3",),
        ("SYS-067", "SYS-068"),
    ),
    Argument(
        "RX synchronised is a cycle late at most, qualified by six samples six: a 200th of a bit",
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
        "the first character begins milliseconds after both",
        ("sci_fifo_receiver: moved past sci.SCICTL1.all = 35: sci.SCIFFRX.all = 24672 | level",),
        ("SCI-205", "SCI-207"),
    ),
    Argument(
        "a slave makes no SCL: the divisors of a master's clock are not used",
        (
            "start_i2c: exchanged: i2c.I2CCLKL.all = 10 --> i2c.I2CCLKL.all = 8",
            "start_i2c: exchanged: i2c.I2CCLKH.all = 5 --> i2c.I2CCLKH.all = 4",
        ),
        ("I2C-042",),
    ),
    Argument(
        "the module is in reset until the last write to SCICTL1, which sets RXENA, too",
        ("sci_fifo_receiver: exchanged: sci.SCICTL1.all = 3 --> sci.SCICTL1.all = 2",),
        ("SCI-013",),
    ),
    Argument(
        "TXINT has no service routine: its bit of PIEIER is 0",
        ("sci_fifo_receiver: exchanged: sci.SCICTL2.all = 0 --> sci.SCICTL2.all = 1",),
        ("SCI-144", "SCI-161"),
    ),
    Argument(
        "brr is 40 in every case, an even number",
        ("sci_fifo_receiver: exchanged: sci.SCILBAUD.all = brr & 255 --> sci.SCILBAUD.all = brr & 254",),
        ("SCI-079",),
    ),
    Argument(
        "the next write sets all of SCIFFRX; the level counts for a FIFO that is out of reset",
        ("sci_fifo_receiver: exchanged: sci.SCIFFRX.all = 0 --> sci.SCIFFRX.all = 1",),
    ),
    Argument(
        "INTM holds every interrupt until dsp.eint(), the last statement of the start-up but one at most, and nothing "
        "asks for one within it",
        (
            "start_pie: moved past pie.PIEACK.all = 4095: pie.PIECTRL.ENPIE = 1",
            f"start_pie: moved past {OF_EACH_INTERRUPT}: pie.PIEACK.all = 4095",
            "start_pie: moved past dsp.enable_interrupt(group): if line:",
            f"start_pie: moved past dsp.eint(): {OF_EACH_INTERRUPT}",
        ),
        ("SYS-151",),
    ),
    Argument(
        "bit 0 is of group 1, of which nothing is enabled",
        ("start_pie: exchanged: pie.PIEACK.all = 4095 --> pie.PIEACK.all = 4094",),
        ("SYS-103",),
    ),
)

OF_THE_ROBUST = (
    Argument(
        "the main loop looks at the frame when the service routine is over, and not before",
        (
            "sci_received: moved past if self.settings.frame_cost:: if not any((word & BROKEN for word in words)):",
            "sci_received: moved past self.frame_waits = True: self.frame = bytes((word & 255 for word in words))",
        ),
    ),
    Argument(
        "the FIFO is empty, and the next 12 characters take a millisecond: no request comes between them",
        (
            "sci_received: moved past sci.SCIFFRX.all = RX_ON | RX_CLEAR | FRAME_BYTES: if self.settings.frame_cost:",
            "sci_received: moved past self.pie.PIEACK.all = GROUP_9: sci.SCIFFRX.all = RX_ON | RX_CLEAR | FRAME_BYTES",
        ),
        ("SCI-175", "SCI-176", "SYS-101"),
    ),
    Argument(
        "receiver and FIFO are in reset until both are released, and RX is idle meanwhile",
        (
            "look_at_line: moved past sci.SCIFFRX.all = FRAME_BYTES: sci.SCICTL1.SWRESET = 0",
            "look_at_line: moved past sci.SCICTL1.SWRESET = 1: sci.SCIFFRX.all = RX_ON | RX_CLEAR | FRAME_BYTES",
        ),
        ("SCI-202", "SCI-205", "SCI-207"),
    ),
    Argument(
        "the next write sets all of SCIFFRX; the level counts for a FIFO that is out of reset",
        ("look_at_line: exchanged: sci.SCIFFRX.all = FRAME_BYTES --> sci.SCIFFRX.all = FRAME_BYTES >> 1",),
    ),
    Argument(
        "fewer than 12 words waited, so RXFFINT is 0; RXFFOVF asks for no interrupt and nobody reads it",
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
        "found is set by each look of the wait before it is returned",
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
        "FREE counts at a breakpoint only",
        ("own_address: exchanged: i2c.I2CMDR.all = FREE | IRS --> i2c.I2CMDR.all = IRS | IRS",),
        ("I2C-324", "I2C-325"),
    ),
    Argument(
        "the two conditions exclude each other: no flag at all is no SDIR and no SCD",
        (
            "serve: moved past if found & SDIR:: if not found:",
            "send: moved past if not found:: if found & SCD:",
        ),
    ),
    Argument(
        "without a return it returns None, and who asks for it asks only whether it is true",
        ("send: deleted: return False",),
    ),
)

ARGUMENTS = (*OF_THE_PUBLISHED, *OF_THE_ROBUST, *OF_THE_START)


def argument_of(mutant: Mutant) -> Argument | None:
    """None for a mutant that some budget should catch."""
    return next((one for one in ARGUMENTS if any(means(text, mutant) for text in one.mutants)), None)


def means(text: str, mutant: Mutant) -> bool:
    """True if an argument's text is about this mutant."""
    return mutant.text in (text, *(text.replace("N cycles", f"{cycles} cycles") for cycles in DELAYS))

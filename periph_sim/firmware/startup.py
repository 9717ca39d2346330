"""Start-up functions of a program: they switch on the clocks of modules and set up pins and the PIE, as TI's code does.

Source: SPRUFB0D sections 5.1 (PCLKCR), 6 (GPIO), 8.3 (PIE); SPRUFZ5A and SPRUG03B for the modules.
"""

from __future__ import annotations

from collections.abc import Callable

from ..processor.dsp import Dsp


def start_pin(dsp: Dsp, pin: int) -> None:
    """Make the pin with this GPIO number an output at level 0, if its MUX field is 0 as after a reset.

    Do nothing if this unit has no module GPIO (key `modules` of the unit in the case).
    """
    if not dsp.has("GPIO"):
        return
    gpio = dsp.module("GPIO")
    port = "ABC"[pin // 32]
    dsp.clear_pin(pin)
    dsp.eallow()
    setattr(gpio[f"GP{port}DIR"], f"GPIO{pin}", 1)
    dsp.edis()


def start_i2c(dsp: Dsp, own_address: int = 0) -> None:
    """Set up I2C-A with a module clock of 10 MHz if SYSCLKOUT is 150 MHz, and leave it in reset (IRS = 0).

    As in TI's code, the inputs of its pins are not synchronized to SYSCLKOUT. own_address: the value of I2COAR.
    """
    clocks = dsp.module("SYS")
    dsp.eallow()
    clocks.PCLKCR0.I2CAENCLK = 1
    if dsp.has("GPIO"):
        gpio = dsp.module("GPIO")
        gpio.GPBQSEL1.GPIO32 = 3
        gpio.GPBQSEL1.GPIO33 = 3
        gpio.GPBMUX1.GPIO32 = 1
        gpio.GPBMUX1.GPIO33 = 1
    dsp.edis()
    i2c = dsp.module("I2C-A")
    i2c.I2CMDR.all = 0
    i2c.I2COAR.all = own_address
    i2c.I2CPSC.all = 14
    i2c.I2CCLKL.all = 10
    i2c.I2CCLKH.all = 5


def sci_fifo_receiver(dsp: Dsp, brr: int, level: int, sciccr: int = 0x07) -> None:
    """Set up SCI-A with a receive FIFO that requests an interrupt when it has `level` words or more.

    brr: LSPCLK / (8 * rate) - 1.
    sciccr: the value of SCICCR; 0x07 is 8 data bits, no parity, one stop bit.
    """
    clocks = dsp.module("SYS")
    dsp.eallow()
    clocks.PCLKCR0.SCIAENCLK = 1
    if dsp.has("GPIO"):
        gpio = dsp.module("GPIO")
        gpio.GPAQSEL2.GPIO28 = 3
        gpio.GPAMUX2.GPIO28 = 1
        gpio.GPAMUX2.GPIO29 = 1
    dsp.edis()
    sci = dsp.module("SCI-A")
    sci.SCICCR.all = sciccr
    sci.SCICTL1.all = 0x03
    sci.SCICTL2.all = 0x00
    sci.SCIHBAUD.all = brr >> 8
    sci.SCILBAUD.all = brr & 0xFF
    sci.SCIFFTX.all = 0xC000  # SCIRST and SCIFFENA set
    sci.SCIFFRX.all = 0x0000  # FIFO held in reset
    sci.SCIFFRX.all = 0x6060 | level  # clears RXFFOVF and RXFFINT, releases the FIFO from reset, enables its interrupt
    sci.SCICTL1.all = 0x23  # SW RESET released; receiver and transmitter enabled


def start_pie(dsp: Dsp, handlers: dict[str, Callable[[], None]]) -> None:
    """Enable the PIE, the interrupts named in `handlers`, and then interrupts as a whole (EINT).

    handlers: a dictionary from names of maskable interrupts, such as "TINT0" or "INT14", to service routines.
    """
    pie = dsp.module("PIE")
    pie.PIECTRL.ENPIE = 1
    # PIEACK is cleared before any line is enabled in PIEIER. In the other order, a pending request could cause two
    # pulses on INTx: the first when its line is enabled, and the second when PIEACK, set by the first, is cleared.
    pie.PIEACK.all = 0xFFF
    for group, line in [dsp.handle(name, handler) for name, handler in handlers.items()]:
        if line:  # 0 for INT13 and above, which do not pass through the PIE
            setattr(pie[f"PIEIER{group}"], f"INTx{line}", 1)
        dsp.enable_interrupt(group)
    dsp.eint()

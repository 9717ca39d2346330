"""Start-up code for one of the three SCIs, which then sends and receives.

RX and TX are GPIO28 and GPIO29 for SCI-A, GPIO19 and GPIO18 for SCI-B, GPIO62 and GPIO63 for SCI-C.

Source: SPRUFB0D sections 5.1 (PCLKCR) and 6 (GPIO); SPRUFZ5A chapter 2.
"""

from __future__ import annotations

from ..f28335.gpio.pin_mux_table import FUNCTIONS
from ..f28335.gpio.register_map import control_register
from ..processor.dsp import Dsp
from ..processor.python.register_view import ModulePort


def start_sci(dsp: Dsp, module: str = "SCI-A", brr: int = 40, sciccr: int = 0x07, fifo: bool = True) -> ModulePort:
    """Set up an SCI to send and receive without interrupts: clock, pins, format and rate. Return its registers.

    brr: LSPCLK / (8 * rate) - 1; 40 is 114 329 baud at an LSPCLK of 37.5 MHz.
    sciccr: the value of SCICCR; 0x07 is 8 data bits, no parity, one stop bit.
    fifo: True to use the FIFOs.
    """
    descriptor = dsp.plan.part.by_name[module]
    clocks = dsp.module("SYS")
    dsp.eallow()
    setattr(clocks.PCLKCR0, descriptor.gate, 1)
    if dsp.has("GPIO"):
        gpio = dsp.module("GPIO")
        for signal, pin in descriptor.pins.items():
            if signal not in descriptor.outputs:
                setattr(gpio[control_register("QSEL", pin)], f"GPIO{pin}", 3)
            setattr(gpio[control_register("MUX", pin)], f"GPIO{pin}", FUNCTIONS[pin].index(signal) + 1)
    dsp.edis()
    sci = dsp.module(module)
    sci.SCICCR.all = sciccr
    sci.SCICTL1.all = 0x03
    sci.SCICTL2.all = 0x00
    sci.SCIHBAUD.all = brr >> 8
    sci.SCILBAUD.all = brr & 0xFF
    sci.SCIFFTX.all = 0xE000 if fifo else 0xA000  # SCIRST and TXFIFOXRESET set; with FIFO also SCIFFENA
    sci.SCIFFRX.all = 0x6040 if fifo else 0x0000  # with FIFO: clears RXFFOVF and RXFFINT, releases the FIFO from reset
    sci.SCICTL1.all = 0x23  # SW RESET released; receiver and transmitter enabled
    return sci

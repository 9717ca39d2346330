"""The IMU emulator with sensors that can be read in any order, or not at all (future work in dissertation section 6.2).

    SCI FIFO interrupt --> frame --> models (GPIO high to low) --> data registers of three chips
    SDA, SCL edges ------> software slave: three addresses --> the addressed chip, its pointer and registers

With bus = "pins", one unit emulates three chips: slave_pins.py serves three addresses without the I2C module. With
bus = "module", each of three units emulates one chip, because an I2C module has one own address.

Each chip has registers, an auto-incremented pointer and the identification of the real chip. As in the real chips, a
read sends the values at the time of its address, so all its bytes are from one run of the models. The models run on
each frame. They also run when all chips were read since the last run, so that noise continues without new frames.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal

from periph_sim.core.table import Duration
from periph_sim.firmware import sci_fifo_receiver, start_pie, start_pin
from periph_sim.processor.dsp import Dsp

from .imu_hil import ACCELEROMETER, FRAME_BYTES, GYROSCOPE, MAGNETOMETER
from .imu_models import NO_FRAME, ModelSettings, models_of, shown
from .register_slave import Registers
from .slave_module import SlaveModule
from .slave_pins import PinCosts, SlavePins

CHIPS = (GYROSCOPE, ACCELEROMETER, MAGNETOMETER)
DATA_AT = {GYROSCOPE: 0x1D, ACCELEROMETER: 0x32, MAGNETOMETER: 0x03}
IDENTIFICATION = {GYROSCOPE: (0x00, b"\x68"), ACCELEROMETER: (0x00, b"\xe5"), MAGNETOMETER: (0x0A, b"H43")}
REGISTERS = 0x40
BROKEN = 0xC000  # mask of SCIFFFE and SCIFFPE in SCIRXBUF
GROUP_9 = 0x100  # mask of group 9 in PIEACK


@dataclass
class Settings(ModelSettings):
    """Settings of a case besides those of the models: addresses, bus, and behaviour of service routines.

    nested: True if interrupts of the bus may interrupt the SCI's service routine.
    """

    bus: Literal["pins", "module"] = "pins"
    addresses: tuple[int, ...] = CHIPS
    models_run: Literal["round", "frame"] = "frame"
    frame_cost: Duration = Fraction(0)  # time that the SCI's service routine takes for a frame
    nested: bool = True
    brr: int = 40
    pin: int = 34  # number of the GPIO that is high while the models run
    costs: PinCosts = field(default_factory=PinCosts)

    def __post_init__(self) -> None:
        super().__post_init__()
        for address in self.addresses:
            if address not in CHIPS:
                raise ValueError(f"addresses has {address:#04x}; the chips are at 0x68, 0x53 and 0x1e")
        if self.bus == "module" and len(self.addresses) != 1:
            raise ValueError(f"an I2C module has one own address, and addresses has {len(self.addresses)}")
        if self.models_run == "round":
            raise ValueError("a round is undefined if any order is possible; leave models_run out")


class EmulatedChip(Registers):
    """A sensor. latched: registers at the last address. was_read: True if read, up to a STOP, since the models ran."""

    def __init__(self, address: int) -> None:
        super().__init__(b"", REGISTERS)
        self._data_at = DATA_AT[address]
        at, name = IDENTIFICATION[address]
        self.registers[at : at + len(name)] = name
        self.latched = bytes(self.registers)
        self.was_read = False
        self._reads = False  # True while the current transfer is a read

    def show(self, codes: bytes) -> None:
        self.registers[self._data_at : self._data_at + len(codes)] = codes
        self.was_read = False

    def addressed(self, reads: bool) -> None:
        super().addressed(reads)
        self.latched = bytes(self.registers)
        self._reads = reads

    def byte(self) -> int:
        return self.latched[self.pointer]

    def over(self) -> None:
        self.was_read = self.was_read or self._reads
        self._reads = False


class Emulator:
    """The firmware's state: the last complete frame, and the chips."""

    def __init__(self, dsp: Dsp, settings: Settings) -> None:
        self.dsp = dsp
        self.settings = settings
        self.frame = NO_FRAME
        self.frame_waits = False  # True if the models have not run yet with `frame`
        self.chips = {address: EmulatedChip(address) for address in settings.addresses}
        self.pie = dsp.module("PIE")
        self.sci = dsp.module("SCI-A") if dsp.has("SCI-A") else None
        self.cost, self.models = settings.run_cost, models_of(settings, dsp)

    def sci_received(self) -> None:
        """Serve SCIRXINTA: the FIFO holds a complete frame."""
        dsp, sci = self.dsp, self.sci
        assert sci is not None
        if self.settings.nested:
            dsp.eint()
        words = [sci.SCIRXBUF.all for _ in range(FRAME_BYTES)]
        if self.settings.frame_cost:
            dsp.compute(self.settings.frame_cost, "frame")
        if not any(word & BROKEN for word in words):
            self.frame = bytes(word & 0xFF for word in words)
            self.frame_waits = True
        sci.SCIFFRX.RXFFOVRCLR = 1
        sci.SCIFFRX.RXFFINTCLR = 1
        dsp.dint()
        self.pie.PIEACK.all = GROUP_9

    def models_are_due(self) -> bool:
        return self.frame_waits or all(chip.was_read for chip in self.chips.values())

    def model(self) -> None:
        dsp = self.dsp
        dsp.set_pin(self.settings.pin)
        frame, self.frame_waits = self.frame, False
        dsp.compute(self.cost, "model")
        codes = shown(frame) if self.models is None else self.models.chips(frame)
        for address, code in zip(CHIPS, codes, strict=True):
            if address in self.chips:
                self.chips[address].show(code)
        dsp.clear_pin(self.settings.pin)

    def run(self) -> None:
        dsp, settings = self.dsp, self.settings
        start_pin(dsp, settings.pin)
        self.model()
        handlers: dict[str, Callable[[], None]] = {}
        if settings.bus == "pins":
            pins = SlavePins(dsp, self.chips, settings.costs)
            pins.start()
            handlers |= {"XINT3": pins.interrupt, "XINT4": pins.interrupt}
        else:
            (address,) = settings.addresses
            module = SlaveModule(dsp, self.chips[address])
            module.start(address)
            handlers |= {"I2CINT1A": module.interrupt}
        if self.sci is not None:
            sci_fifo_receiver(dsp, settings.brr, FRAME_BYTES)
            handlers |= {"SCIRXINTA": self.sci_received}
        start_pie(dsp, handlers)
        while True:
            dsp.dint()  # an interrupt after the check below then ends IDLE at once, and is served after EINT
            if self.models_are_due():
                dsp.eint()
                self.model()
            else:
                dsp.cpu.idle()
                dsp.eint()


def main(dsp: Dsp, settings: Settings) -> None:
    Emulator(dsp, settings).run()

"""The IMU emulator's firmware: receives host frames over SCI and emulates three sensor chips on I2C.

    SCI FIFO interrupt --> frame --> models (GPIO high to low) --> data of three chips
    request of the sensor head --> own address, pointer byte, SDIR, I2CDXR/XRDY, SCD

The steps are those of the dissertation (Figs. A.2 and A.4, sections 3.4 and 4.3.5). As in the dissertation, registers
are written field by field: each assignment to a field reads and writes the whole register.

A frame is six signed 16-bit values, low byte first: roll, pitch, yaw, then acceleration x, y, z. With arithmetic =
"bytes" the chips show these values, so a byte on the bus identifies its frame. The gyroscope shows the angles, the
accelerometer the accelerations, and the magnetometer the angles again, each in its chip's order of axes and bytes. With
any other arithmetic ("float64", "float32", "q16", ...) the chips show the output of the sensor models.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction

from periph_sim.core.table import Duration, HexBytes
from periph_sim.firmware import sci_fifo_receiver, start_i2c, start_pie, start_pin
from periph_sim.processor.dsp import Dsp

from .imu_models import NO_FRAME, ModelSettings, models_of, shown

FRAME_BYTES = 12
GYROSCOPE, ACCELEROMETER, MAGNETOMETER = 0x68, 0x53, 0x1E


@dataclass
class Settings(ModelSettings):
    """Settings besides those of the models. sdir_wait: True to wait for SDIR before sending the first byte."""

    frame_cost: Duration = Fraction(0)  # time that the SCI's service routine takes for a frame
    sdir_wait: bool = True
    mask_during_i2c: bool = False  # True: INTM is set from the own address to the end of the read
    order: tuple[int, ...] = (GYROSCOPE, ACCELEROMETER, MAGNETOMETER)
    count: int = 6
    brr: int = 40
    fifo_level: int = FRAME_BYTES  # level of the receive FIFO that causes an interrupt
    pin: int = 34  # number of the GPIO that is high while the models run
    table: dict[str, HexBytes] = field(default_factory=dict)  # maps the address of a chip to data that it always shows


class Emulator:
    """The firmware's state: the last frame, and the bytes of each chip."""

    def __init__(self, dsp: Dsp, settings: Settings) -> None:
        self.dsp = dsp
        self.settings = settings
        self.frame = NO_FRAME
        self.frame_waits = False  # True if the models have not run yet with `frame`
        self.data = {address: bytes(6) for address in (GYROSCOPE, ACCELEROMETER, MAGNETOMETER)}
        self.i2c = dsp.module("I2C-A")
        self.cost, self.models = settings.run_cost, models_of(settings, dsp)
        self.sci = dsp.module("SCI-A") if dsp.has("SCI-A") else None
        self.pie = dsp.module("PIE") if dsp.has("SCI-A") else None

    # SCI ---------------------------------------------------------------------

    def sci_received(self) -> None:
        """Serve SCIRXINTA: read twelve bytes, which are a frame if none was lost and `fifo_level` is FRAME_BYTES."""
        sci, pie = self.sci, self.pie
        assert sci is not None and pie is not None
        self.frame = bytes(sci.SCIRXBUF.all & 0xFF for _ in range(FRAME_BYTES))
        if self.settings.frame_cost:
            self.dsp.compute(self.settings.frame_cost, "frame")
        self.frame_waits = True
        sci.SCIFFRX.RXFFOVRCLR = 1
        sci.SCIFFRX.RXFFINTCLR = 1
        pie.PIEACK.all = 0x100  # group 9

    # Models ------------------------------------------------------------------

    def model(self) -> None:
        dsp, settings = self.dsp, self.settings
        dsp.set_pin(settings.pin)
        frame, self.frame_waits = self.frame, False
        dsp.compute(self.cost, "model")
        codes = shown(frame) if self.models is None else self.models.chips(frame)
        self.data[GYROSCOPE], self.data[ACCELEROMETER], self.data[MAGNETOMETER] = codes
        for chip, fixed in settings.table.items():
            self.data[int(chip, 0)] = fixed
        dsp.clear_pin(settings.pin)

    # I2C ---------------------------------------------------------------------

    def slave_config(self, address: int) -> None:
        """Set the own address, as I2C_SLAVE_CONFIG of the dissertation does (Fig. A.2)."""
        i2c = self.i2c
        i2c.I2CMDR.IRS = 0
        i2c.I2CMDR.MST = 0
        i2c.I2COAR.all = address
        i2c.I2CMDR.IRS = 1

    def batch_read(self, data: bytes) -> int:
        """Serve one read, as i2cBatchRead of the dissertation does (Fig. A.4). Return the NACK flag at its end."""
        i2c, dsp = self.i2c, self.dsp
        dsp.spin(lambda: i2c.I2CSTR.AAS == 1)
        if self.settings.mask_during_i2c:
            dsp.dint()
        i2c.I2CCNT.all = 1
        dsp.spin(lambda: i2c.I2CSTR.RRDY == 1)
        i2c.I2CMDR.TRX = 1
        i2c.I2CCNT.all = self.settings.count
        i2c.I2CSTR.SCD = 1
        if self.settings.sdir_wait:
            dsp.spin(lambda: i2c.I2CSTR.SDIR == 1)
        buffer = endless(data)
        while True:
            i2c.I2CDXR.all = next(buffer)
            if dsp.spin_either(lambda: i2c.I2CSTR.XRDY == 1, lambda: i2c.I2CSTR.SCD == 1):
                break
        i2c.I2CMDR.IRS = 1
        if self.settings.mask_during_i2c:
            dsp.eint()
        return i2c.I2CSTR.NACK

    # The main loop -----------------------------------------------------------

    def run(self) -> None:
        dsp, settings = self.dsp, self.settings
        start_pin(dsp, settings.pin)
        start_i2c(dsp)
        if self.sci is not None:
            sci_fifo_receiver(dsp, settings.brr, settings.fifo_level)
            start_pie(dsp, {"SCIRXINTA": self.sci_received})
        if settings.models_run == "frame":
            self.serve_frame_by_frame()
        while True:
            self.model()
            for address in settings.order:
                self.slave_config(address)
                self.batch_read(self.data[address])

    def serve_frame_by_frame(self) -> None:
        """Serve rounds. Run the models on each frame that comes before a round, or if none came, after the round."""
        dsp, i2c = self.dsp, self.i2c
        first, *others = self.settings.order
        self.model()
        while True:
            ran = False
            self.slave_config(first)
            while dsp.spin_either(lambda: i2c.I2CSTR.AAS == 1, lambda: self.frame_waits):
                self.model()
                ran = True
            self.batch_read(self.data[first])
            for address in others:
                self.slave_config(address)
                self.batch_read(self.data[address])
            if not ran:
                self.model()


def endless(data: bytes) -> Iterator[int]:
    """Yield the data, then zeros without end, like a C pointer that moves past the end of its buffer."""
    yield from data
    while True:
        yield 0


def main(dsp: Dsp, settings: Settings) -> None:
    Emulator(dsp, settings).run()

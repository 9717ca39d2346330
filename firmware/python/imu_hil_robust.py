"""A robust version of the IMU emulator imu_hil, which recovers from faults on the bus and on the serial line.

    SCI FIFO interrupt --> frame, unless a character is broken      if RX is idle with characters left: reset receiver
    frame complete ------> models, unless a round is near           if no frame came before a round: models after round
    request -------------> own address, pointer, SDIR, I2CDXR/XRDY  if a wait times out: back to the first chip

Differences from imu_hil, with their reasons:

* Every wait is limited by TIMER1 (`patience`): an aborted request costs only its round.
* It clears SCD by writing a 1 to this bit only, and never writes back a value that it has read from I2CSTR. So no flag
  is lost. IRS = 0 clears the flags of an aborted request.
* It reads every byte from I2CDRR, so SCL is not stretched if a driver writes a byte after the pointer to set up a chip.
* A frame ends when RX is idle: characters left in the FIFO without new ones belong to a broken frame, and are
  discarded. So a lost character costs one frame, not all later ones.
* The models run when a frame arrives, so a read has the values of the last frame, not of the frame before. No model run
  starts in a round, unless it was aborted, or `guard` before it. TIMER0 predicts a round from the start of the last.

Source: dissertation section 3.4 (work to be done); SPRUG03B (W1C flags, IRS), SPRUFZ5A (FIFO), SPRUFB0D 5.5 (timers).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from periph_sim.core.table import Duration
from periph_sim.firmware import sci_fifo_receiver, start_i2c, start_pie, start_pin
from periph_sim.processor.dsp import Dsp
from periph_sim.processor.python.register_view import ModulePort

from .imu_hil import ACCELEROMETER, FRAME_BYTES, GYROSCOPE, MAGNETOMETER, endless
from .imu_models import NO_FRAME, ModelSettings, models_of, shown

RRDY, XRDY, SCD, AAS, SDIR = 1 << 3, 1 << 4, 1 << 5, 1 << 9, 1 << 14  # masks in I2CSTR
IRS, FREE = 1 << 5, 1 << 14  # masks in I2CMDR
BROKEN = 0xC000  # mask of SCIFFFE and SCIFFPE in SCIRXBUF
RX_ON, RX_CLEAR = 0x2020, 0x4040  # masks in SCIFFRX: RXFIFORESET and RXFFIENA; RXFFOVRCLR and RXFFINTCLR
RELOAD = 0x8020  # value of TCR that clears TIF and reloads the timer (TRB)
GROUP_9 = 0x100  # mask of group 9 in PIEACK
SYSCLKOUT = 150_000_000


@dataclass
class Settings(ModelSettings):
    """Settings besides those of the models. period: time from one round to the next.

    guard: time before a round in which no model run starts. It must exceed the run time plus all jitter of rounds.
    patience: the longest wait. It must exceed the 2 bytes from the last write of I2CDXR to the STOP. Between rounds, RX
        counts as idle after this time without a character.
    """

    models_run: Literal["round", "frame"] = "frame"
    frame_cost: Duration = Fraction(0)  # time that the SCI's service routine takes for a frame
    order: tuple[int, ...] = (GYROSCOPE, ACCELEROMETER, MAGNETOMETER)
    brr: int = 40
    pin: int = 34  # number of the GPIO that is high while the models run
    period: Duration = Fraction(20, 1000)
    guard: Duration = Fraction(500, 1_000_000)
    patience: Duration = Fraction(400, 1_000_000)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.run_cost.most < self.guard < self.period:
            raise ValueError("guard must be longer than the model run, and shorter than period")


class Emulator:
    """The firmware's state: the last complete frame, and the bytes of each chip."""

    def __init__(self, dsp: Dsp, settings: Settings) -> None:
        self.dsp = dsp
        self.settings = settings
        self.frame = NO_FRAME
        self.frame_waits = False  # True if the models have not run yet with `frame`
        self.left = 0  # number of characters in the FIFO at the last check
        self.overdue = 0  # number of timed-out waits since the guard time of the next round began
        self.data = {address: bytes(6) for address in settings.order}
        self.i2c = dsp.module("I2C-A")
        self.sci = dsp.module("SCI-A")
        self.pie = dsp.module("PIE")
        self.round_timer = dsp.module("TIMER0")
        self.wait_timer = dsp.module("TIMER1")
        self.cost, self.models = settings.run_cost, models_of(settings, dsp)

    # SCI ---------------------------------------------------------------------

    def sci_received(self) -> None:
        """Serve SCIRXINTA: the FIFO holds a complete frame."""
        sci = self.sci
        words = [sci.SCIRXBUF.all for _ in range(FRAME_BYTES)]
        if not any(word & BROKEN for word in words):
            self.frame = bytes(word & 0xFF for word in words)
            self.frame_waits = True
        if self.settings.frame_cost:
            self.dsp.compute(self.settings.frame_cost, "frame")
        sci.SCIFFRX.all = RX_ON | RX_CLEAR | FRAME_BYTES
        self.pie.PIEACK.all = GROUP_9

    def look_at_line(self) -> None:
        """Reset the receiver if the FIFO level is unchanged since the last check, and data or an error is left."""
        sci = self.sci
        left = sci.SCIFFRX.RXFFST
        if left == self.left and (left or sci.SCIRXST.RXERROR):
            sci.SCICTL1.SWRESET = 0
            sci.SCIFFRX.all = FRAME_BYTES  # FIFO in reset
            sci.SCIFFRX.all = RX_ON | RX_CLEAR | FRAME_BYTES
            sci.SCICTL1.SWRESET = 1
            left = 0
        self.left = left

    # Models ------------------------------------------------------------------

    def model(self) -> None:
        dsp = self.dsp
        dsp.set_pin(self.settings.pin)
        frame, self.frame_waits = self.frame, False
        dsp.compute(self.cost, "model")
        codes = shown(frame) if self.models is None else self.models.chips(frame)
        self.data = dict(zip((GYROSCOPE, ACCELEROMETER, MAGNETOMETER), codes, strict=True))
        dsp.clear_pin(self.settings.pin)

    # I2C ---------------------------------------------------------------------

    def own_address(self, address: int) -> None:
        """Set the address of the next chip. IRS = 0 releases the bus and resets all flags but BB."""
        i2c = self.i2c
        i2c.I2CMDR.all = 0
        i2c.I2COAR.all = address
        i2c.I2CMDR.all = FREE | IRS

    def wait_for(self, flags: int) -> int:
        """Wait until any of these flags of I2CSTR is set. Return those that are set, or 0 after a timeout."""
        i2c, timer, found = self.i2c, self.wait_timer, 0

        def one_of_them() -> bool:
            nonlocal found
            found = i2c.I2CSTR.all & flags
            return found != 0 or timer.TCR.TIF == 1

        timer.TCR.all = RELOAD
        self.dsp.spin(one_of_them)
        return found

    def serve(self, data: bytes) -> bool:
        """Serve a request, from its address to its STOP. Return False if the request was aborted."""
        i2c = self.i2c
        while True:
            found = self.wait_for(RRDY | SDIR | SCD)
            if not found:
                return False
            if found & SDIR:
                return self.send(data)
            if found & RRDY:
                _ = i2c.I2CDRR.all  # the register pointer, or a byte that follows it
            else:
                i2c.I2CSTR.all = SCD  # a STOP follows the pointer, so the read has a START of its own

    def send(self, data: bytes) -> bool:
        for byte in endless(data):
            self.i2c.I2CDXR.all = byte
            found = self.wait_for(XRDY | SCD)
            if found & SCD:
                return True
            if not found:
                break
        return False

    # The main loop -----------------------------------------------------------

    def wait_for_round(self) -> bool:
        """Wait for the first chip's address. Run the models on each frame, if so set; return True if they ran."""
        i2c, near, late, ran = self.i2c, self.round_timer, self.wait_timer, False
        frames = self.settings.models_run == "frame"

        def something_to_do() -> bool:
            if i2c.I2CSTR.AAS == 1 or late.TCR.TIF == 1:
                return True
            return frames and self.frame_waits and near.TCR.TIF == 0

        while True:
            late.TCR.all = RELOAD
            self.dsp.spin(something_to_do)
            if i2c.I2CSTR.AAS == 1:
                near.TCR.all = RELOAD
                self.overdue = 0
                return ran
            if late.TCR.TIF == 1:
                self.look_at_line()
                self.look_at_round()
            else:
                self.model()
                ran = True

    def look_at_round(self) -> None:
        """If the predicted round is about one guard time overdue, predict the next one, so that the models can run."""
        if self.round_timer.TCR.TIF == 1:
            self.overdue += 1
            if self.overdue * self.settings.patience > 2 * self.settings.guard:
                self.round_timer.TCR.all = RELOAD
                self.overdue = 0

    def serve_round(self) -> None:
        first, *others = self.settings.order
        self.own_address(first)
        ran = self.wait_for_round()
        whole = self.serve(self.data[first])
        for address in others:
            if whole:
                self.own_address(address)
                whole = bool(self.wait_for(AAS)) and self.serve(self.data[address])
        if not ran:
            self.model()

    def run(self) -> None:
        dsp, settings = self.dsp, self.settings
        start_pin(dsp, settings.pin)
        start_i2c(dsp)
        sci_fifo_receiver(dsp, settings.brr, FRAME_BYTES)
        start_pie(dsp, {"SCIRXINTA": self.sci_received})
        self.start_timer(self.round_timer, settings.period - settings.guard)
        self.start_timer(self.wait_timer, settings.patience)
        self.model()
        while True:
            self.serve_round()

    def start_timer(self, timer: ModulePort, length: Fraction) -> None:
        """Start a timer that sets TIF each time `length` has passed."""
        timer.PRD.all = int(length * SYSCLKOUT)
        timer.TCR.all = RELOAD


def main(dsp: Dsp, settings: Settings) -> None:
    Emulator(dsp, settings).run()

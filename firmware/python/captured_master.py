"""A master that performs a list of transfers, such as those of a capture, with the registers of I2C-A.

    "50 W 00 Sr 50 R 6"  -->  START, address, bytes, repeated START, address, bytes, STOP  -->  the bus

Each transfer is a text as in the I2C specification: a 7-bit address in hexadecimal, then W with the bytes to write or
R with the number of bytes to read. Sr separates parts; START and STOP are implied. `R 6 ACK` also acknowledges the last
byte if mr_nack_at_count0 = only_with_stp, which is not the default. Transfer n begins `pauses[n]`, or 0, after the
previous STOP. After a NACK, firmware begins the next part or, in the last part, sets STP to end the transfer.

Non-repeat mode (RM = 0) counts the bytes with I2CCNT; an address without data needs RM = 1, since I2CCNT = 0
means 65536.

Source: SPRUG03B Tables 5 and 6 (RM, STT, STP, NACKMOD), section 2.5.4; TI's i2c_eeprom example for the settings.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated

from periph_sim.core.table import Duration
from periph_sim.firmware import After, start_i2c
from periph_sim.processor.dsp import Dsp

FREE, STT, STP, MST, TRX, RM, IRS = 0x4000, 0x2000, 0x0800, 0x0400, 0x0200, 0x0080, 0x0020  # masks in I2CMDR
FLAGS = 0x0026  # mask of SCD, ARDY and NACK in I2CSTR, which are cleared by writing ones
REPLAY = ("script", "pauses", "low", "high")  # settings that a replay sets from the capture


@dataclass(frozen=True)
class TransferPart:
    """A part of a transfer, from a START to the next START or STOP. count: bytes to read; None for a write."""

    address: int
    data: bytes = b""
    count: int | None = None
    ack_last: bool = False


def parts(transfer: str) -> list[TransferPart]:
    """Parse the text of a transfer into its parts. Raise ValueError if the text is invalid."""
    return [_part(text) for text in transfer.split(" Sr ")]


def _part(text: str) -> TransferPart:
    try:
        address, direction, *rest = text.split()
        if direction == "W":
            return TransferPart(int(address, 16), bytes(int(byte, 16) for byte in rest))
        if direction == "R" and rest[1:] in ([], ["ACK"]):
            return TransferPart(int(address, 16), count=int(rest[0]), ack_last=bool(rest[1:]))
    except (ValueError, IndexError):
        pass
    raise ValueError(f"{text!r} is not a part of a transfer; expected for example '50 W 00 1f' or '50 R 6'")


def _readable(transfer: str) -> str:
    parts(transfer)
    return transfer


@dataclass
class Settings:
    """The settings that a case can give to this program."""

    script: tuple[Annotated[str, After(_readable)], ...] = ("50 W 00 Sr 50 R 6",)
    pauses: tuple[Duration, ...] = ()
    low: int = 45  # I2CCLKL: SCL is low for 45 + 5 cycles of 10 MHz, which gives 100 kHz
    high: int = 45


class Master:
    """The master with the results of its transfers. got: the bytes of each read, in order."""

    def __init__(self, dsp: Dsp, settings: Settings) -> None:
        self.dsp = dsp
        self.settings = settings
        self.i2c = dsp.module("I2C-A")
        self.got: list[bytearray] = []

    def transfer(self, steps: list[TransferPart]) -> None:
        i2c, dsp = self.i2c, self.dsp
        dsp.spin(lambda: i2c.I2CMDR.STP == 0)
        dsp.spin(lambda: i2c.I2CSTR.BB == 0)
        for number, part in enumerate(steps):
            i2c.I2CSTR.all = FLAGS
            i2c.I2CSAR.all = part.address
            last = number + 1 == len(steps)
            if part.count:
                self.read(part, part.count, last)
            elif part.data:
                self.write(part, last)
            else:
                self.call(part, last)
        dsp.spin(lambda: i2c.I2CSTR.SCD == 1)
        i2c.I2CSTR.all = FLAGS

    def write(self, part: TransferPart, last: bool) -> None:
        i2c, dsp = self.i2c, self.dsp
        i2c.I2CCNT.all = len(part.data)
        i2c.I2CMDR.all = FREE | STT | MST | TRX | IRS | (STP if last else 0)
        for byte in part.data:
            if dsp.spin_either(lambda: i2c.I2CSTR.XRDY == 1, lambda: i2c.I2CSTR.NACK == 1):
                break
            i2c.I2CDXR.all = byte
        self.end(last)

    def read(self, part: TransferPart, count: int, last: bool) -> None:
        i2c, dsp = self.i2c, self.dsp
        by_command = last and part.ack_last  # True: STP is set only after all bytes were received and acknowledged
        i2c.I2CCNT.all = count
        i2c.I2CMDR.all = FREE | STT | MST | IRS | (STP if last and not by_command else 0)
        got = bytearray()
        self.got.append(got)
        for left in range(count, 0, -1):
            if left == 1 and not last and not part.ack_last:
                i2c.I2CMDR.NACKMOD = 1
            if dsp.spin_either(lambda: i2c.I2CSTR.RRDY == 1, lambda: i2c.I2CSTR.NACK == 1):
                break
            got.append(i2c.I2CDRR.all)
        if by_command and i2c.I2CSTR.NACK == 0:
            dsp.spin(lambda: i2c.I2CSTR.ARDY == 1)
            i2c.I2CMDR.STP = 1
        else:
            self.end(last)

    def call(self, part: TransferPart, last: bool) -> None:
        """Send an address without data."""
        i2c, dsp = self.i2c, self.dsp
        direction = TRX if part.count is None else 0
        i2c.I2CMDR.all = FREE | STT | MST | direction | RM | IRS
        dsp.spin(lambda: i2c.I2CMDR.STT == 0)
        if last:
            i2c.I2CMDR.STP = 1
        self.end(last)

    def end(self, last: bool) -> None:
        """Wait for the STOP or, before another part, for ARDY. A NACK ends the wait; in the last part, set STP then."""
        i2c, dsp = self.i2c, self.dsp
        if last:
            if dsp.spin_either(lambda: i2c.I2CSTR.SCD == 1, lambda: i2c.I2CSTR.NACK == 1):
                i2c.I2CMDR.STP = 1
        else:
            dsp.spin(lambda: i2c.I2CSTR.ARDY == 1 or i2c.I2CSTR.NACK == 1)

    def run(self) -> None:
        settings, i2c = self.settings, self.i2c
        script = [parts(transfer) for transfer in settings.script]
        start_i2c(self.dsp)
        i2c.I2CCLKL.all = settings.low
        i2c.I2CCLKH.all = settings.high
        i2c.I2CMDR.all = IRS
        for number, transfer in enumerate(script):
            pause = settings.pauses[number] if number < len(settings.pauses) else Fraction(0)
            if pause:
                self.dsp.compute(pause)
            with self.dsp.span("transfer"):
                self.transfer(transfer)


def main(dsp: Dsp, settings: Settings) -> None:
    Master(dsp, settings).run()

"""A bare I2C module on the bus of i2c_bus.py, and a master whose edges the test controls.

The methods of the master end at the edges that the rules mention: `rise` and `fall` end exactly
in the cycle of that edge, so the eighth `clock` of a byte ends at fall 8. A data bit changes a
quarter of a bit after SCL fell. The master releases SCL half a bit after it fell, and waits if
the chip still pulls it. `decoded` returns the decoded transfers; `drive`, `run_until` and `show`
are those of timing diagrams (tests/waves.py).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Self

from periph_sim.core.options import Value, options_from
from periph_sim.f28335.i2c.module import I2c
from periph_sim.f28335.i2c.options import I2cOptions

from .i2c_bus import RELEASED, SCL, SDA, Bus
from .i2c_registers import FLAGS, IRS, MST, OFFSET, STT, TRX

OWN = 0x48  # the own address of most tests
OTHER = 0x2A
BIT = 1500  # 100 kHz at 150 MHz
NO_FILTER: dict[str, Value] = {"noise_filter_cycles": 0}


class Module(I2c):
    """A Python class, so that tests can replace its methods even if the core is compiled."""


class Rig(Bus):
    """A bus with the module under test, `chip`. Its clock is on, IPSC is 14, and it is in reset until `begin`.

    The options are those of I2cOptions. The noise filter is off unless a test enables it, so that
    a flag changes in the cycle of its edge.
    """

    def __init__(self, *, bit: int = BIT, **options: Value) -> None:
        self.chip = Module(options_from(I2cOptions, NO_FILTER | options))
        self.bit = bit
        self.hold = bit // 8  # in diagrams: cycles from the start of a column until the master changes SDA
        self.sampled = 1  # the level of SDA just before the last fall of SCL
        self.interrupts: list[tuple[int, int]] = []  # (cycle, lines)
        super().__init__([self.chip])
        self.set_up()
        self.write("I2CSAR", 0)

    # Registers

    def set_up(self) -> None:
        """Enable the clock of the module and set its rates."""
        self.chip.gate(self.now, True)
        self.write("I2CPSC", 14)
        self.write("I2CCLKL", 10)
        self.write("I2CCLKH", 5)

    def read(self, name: str, wait: int = 0) -> int:
        """Return the value that the CPU reads after a number of cycles."""
        self.wait(wait)
        value = self.chip.read(self.now, OFFSET[name])
        self.settle()
        return value

    def write(self, name: str, *values: int) -> None:
        """Write values to a register, one after the other."""
        for value in values:
            self.chip.write(self.now, OFFSET[name], value)
            self.settle()

    def peek(self, name: str, wait: int = 0) -> int:
        """Return the value that a debugger sees after a number of cycles."""
        if wait:
            self.wait(wait)
        return self.chip.peek(self.now, OFFSET[name])

    def begin(
        self, mode: int = 0, oar: int = OWN, *, ier: int = 0, bcm: int | None = None, fifos: tuple[int, int] = (0, 0)
    ) -> Self:
        """Set I2CIER, BCM unless None, I2CFFTX and I2CFFRX, and I2COAR; then write I2CMDR with IRS = 1."""
        if ier:
            self.write("I2CIER", ier)
        if bcm is not None:
            self.write("I2CEMDR", bcm)
        if any(fifos):
            self.set_fifos(*fifos)
        self.write("I2COAR", oar)
        self.write("I2CMDR", mode | IRS)
        return self

    def begin_again(self, mode: int = 0) -> None:
        """Write IRS = 0, then 1."""
        self.write("I2CMDR", 0)
        self.write("I2CMDR", mode | IRS)

    def write_other(self, count: int = 1) -> None:
        """Make the chip a master that sends a START and a first byte to OTHER."""
        self.write("I2CSAR", OTHER)
        self.write("I2CCNT", count)
        self.write("I2CDXR", 0x77)
        self.write("I2CMDR", IRS | MST | TRX | STT)

    def reset(self) -> None:
        """Apply a system reset and enable the clock of the module again."""
        self.chip.reset(self.now)
        self.chip.gate(self.now, True)

    def set_fifos(self, tx: int, rx: int) -> None:
        """Write I2CFFTX and I2CFFRX."""
        self.write("I2CFFTX", tx)
        self.write("I2CFFRX", rx)

    def status(self, bits: int = 0xFFFF) -> int:
        """Return I2CSTR masked with `bits`, read without side effects."""
        return self.peek("I2CSTR") & bits

    def flag(self, name: str) -> int:
        return int(self.status(FLAGS[name]) != 0)

    def duties(self) -> list[str]:
        """Return the texts of the "duty" notes, which report broken rules, and remove all notes."""
        texts = [note.text for note in self.chip.notes if note.code == "duty"]
        self.chip.notes.clear()
        return texts

    def requested(self, wait: int = 0) -> int:
        """Wait for a number of cycles, then return the interrupt lines that were requested since the last call."""
        self.wait(wait)
        lines = 0
        for _, mask in self.interrupts:
            lines |= mask
        self.interrupts.clear()
        return lines

    def write_each(self, *data: int) -> None:
        """Write each byte to I2CDXR, 40 cycles apart; XRDY must be 1 for each."""
        for byte in data:
            assert self.flag("XRDY"), f"XRDY is 0 before {byte:#x} is written to I2CDXR"
            self.write("I2CDXR", byte)
            self.wait(40)

    # The wires

    @property
    def line(self) -> int:
        """Return the levels on the bus: SCL in bit 0, SDA in bit 1."""
        return self.level[SCL] | self.level[SDA] << 1

    @property
    def stretching(self) -> bool:
        return not self.chip.out >> SCL & 1

    @property
    def pulling_sda(self) -> bool:
        return not self.chip.out >> SDA & 1

    @property
    def released(self) -> bool:
        """True if the chip pulls neither line."""
        return self.chip.out == RELEASED

    def settle(self) -> None:
        super().settle()
        if self.chip.requests:
            self.interrupts.append((self.now, self.chip.requests))
            self.chip.requests = 0

    def put(self, scl: int | None = None, sda: int | None = None) -> None:
        """Release (1) or pull (0) a line, or both lines at once, as the master."""
        for line, level in ((SCL, scl), (SDA, sda)):
            if level is not None:
                self.driver.put(line, level)
        self.settle()

    def wait(self, cycles: int) -> None:
        self.run_until(self.now + cycles)

    def wait_for(self, condition: Callable[[], object], limit: int = 20_000) -> int:
        """Run until the condition holds, which is checked in every cycle, and return the number of cycles."""
        begun = self.now
        while not condition():
            assert self.now - begun < limit, f"the condition did not hold within {limit} cycles"
            self.run_until(self.now + 1)
        return self.now - begun

    # Edges of the master

    def rise(self, sda: int = 1) -> None:
        """After a fall of SCL, put a bit on SDA and release SCL. Ends in the cycle in which SCL is high."""
        self.wait(self.bit // 4)
        self.put(sda=sda)
        self.wait(self.bit // 4)
        self.put(scl=1)
        given_up = self.now + 100 * self.bit
        while not self.level[SCL]:
            assert self.now < given_up, f"SCL held low since {given_up - 100 * self.bit}"
            self.run_until(min(max(self.chip.next_wake, self.now + 1), given_up))

    def fall(self) -> None:
        """After a rise of SCL, pull SCL half a bit later. Ends in that cycle."""
        self.wait(self.bit // 2)
        self.sampled = self.level[SDA]
        self.put(scl=0)

    def clock(self, sda: int = 1) -> int:
        """Send one pulse of SCL and return the level of SDA at its end. Ends at the fall."""
        self.rise(sda)
        self.fall()
        return self.sampled

    def start(self) -> None:
        """Send a START on a free bus. Ends at the fall of SCL that follows."""
        self.wait(self.bit)
        self.put(sda=0)
        self.fall()

    def restart(self, first: int | None = None) -> bool:
        """Send a repeated START after a fall of SCL. Ends at the next fall of SCL, or at fall 9 of the first byte.

        Return True if that byte was acknowledged.
        """
        self.rise(1)
        self.wait(self.bit // 4)
        self.put(sda=0)
        self.fall()
        return first is not None and self.send(first)

    def stop(self) -> None:
        """Send a STOP after a fall of SCL. Ends at the rise of SDA."""
        self.rise(0)
        self.wait(self.bit // 4)
        self.put(sda=1)

    # Bytes of the master

    def send_bits(self, value: int, bits: int = 8) -> None:
        """Send data bits, most significant first. Ends at the fall after the last."""
        for n in reversed(range(bits)):
            self.clock(value >> n & 1)

    def acked(self) -> bool:
        """Send the ninth pulse with SDA released, and return True if the chip acknowledges. Ends at fall 9."""
        return self.clock(1) == 0

    def send(self, value: int, bits: int = 8) -> bool:
        """Send a byte to the chip and return True if it was acknowledged. Ends at fall 9."""
        self.send_bits(value, bits)
        return self.acked()

    def read_bits(self, bits: int = 8) -> int:
        value = 0
        for _ in range(bits):
            value = value << 1 | self.clock(1)
        return value

    def read_byte(self, ack: bool = True, bits: int = 8) -> int:
        """Read a byte from the chip, and send ACK or NACK. Ends at fall 9."""
        value = self.read_bits(bits)
        self.clock(0 if ack else 1)
        return value

    def address(self, address: int = OWN, read: int = 0) -> bool:
        """Send a START and the address byte, and return True if it was acknowledged. Ends at fall 9."""
        self.start()
        return self.send(address << 1 | read)

    def receive(self, *data: int, address: int = OWN) -> None:
        """Send a START, the address byte and data bytes, whether acknowledged or not. Ends at fall 9."""
        self.address(address)
        for byte in data:
            self.send(byte)

    def send_and_read(self, byte: int) -> int:
        """Send a byte, which the chip must acknowledge, and return what its CPU reads."""
        assert self.send(byte), f"{byte:#x} is not acknowledged"
        return self.read("I2CDRR")

    def write_and_read_byte(self, byte: int, ack: bool = True) -> int:
        """Write I2CDXR as the chip's CPU, and return the byte that the master reads and answers with ACK or NACK."""
        self.write("I2CDXR", byte)
        return self.read_byte(ack)

    def begin_read(self) -> None:
        """Send a START and the address byte of a read without its ninth pulse."""
        self.start()
        self.send_bits(OWN << 1 | 1)

    # Timing diagrams

    def drive(self, now: int, signal: str, level: int) -> None:
        """Change a line as the master or access a register as the CPU.

        SCL, SDA: the level of the line; SDA changes `hold` cycles later.
        LINES: both levels at once, SCL in bit 0.
        DXR: the value that is written to I2CDXR.
        DRR, ISRC: the register is read.
        """
        self.run_until(now)
        if signal == "SCL":
            self.put(scl=level)
        elif signal == "SDA":
            self.driver.put_later(now + self.hold, SDA, level)
        elif signal == "LINES":
            self.put(level & 1, level >> 1)
        elif signal == "DXR":
            self.write("I2CDXR", level)
        elif signal in ("DRR", "ISRC"):
            self.read("I2C" + signal)
        else:
            raise ValueError(f"a diagram can drive SCL, SDA, LINES, DXR, DRR and ISRC; not {signal}")

    def show(self, signal: str) -> int:
        """Return a level of the bus (SCL, SDA) or of the chip's outputs (scl, sda), a flag, a FIFO count or a code."""
        if signal in FLAGS:
            return self.flag(signal)
        if signal == "INTCODE":
            return self.peek("I2CISRC") & 7
        if signal in ("TXFFST", "RXFFST"):
            return self.peek("I2CFF" + signal[:2]) >> 8 & 31
        if signal in ("SCL", "SDA"):
            return self.line >> (signal == "SDA") & 1
        if signal in ("scl", "sda"):
            return self.chip.out >> (signal == "sda") & 1
        raise ValueError(f"no signal {signal}")


def addressed(
    read: int = 0, *, mode: int = 0, first: int | None = None, sent: Iterable[int] = (), ier: int = 0, **options: Value
) -> Rig:
    """Return a rig at fall 9 of the own address, or of the last byte sent after it.

    read: 1 if the master reads.
    mode: value of I2CMDR without IRS.
    first: value written to I2CDXR in the first half of the acknowledge slot, so that there is no underflow.
    sent: bytes sent to the chip after the address, whether acknowledged or not.
    ier: value of I2CIER, written after these bytes.
    """
    rig = Rig(bit=BIT, **options)
    rig.begin(mode)
    rig.start()
    rig.send_bits(OWN << 1 | read)
    if first is not None:
        rig.write("I2CDXR", first)
    assert rig.acked()
    for byte in sent:
        rig.send(byte)
    if ier:
        rig.write("I2CIER", ier)
    return rig

"""Waveform files of a run: .vcd, .fst and .sr. They show these signals (.sr: 64 at most, of one bit, no fields):

    EDGE   wires.SCL                     a wire: SCL, SDA, RX, TX, each named pin, and any other wire that changes
    FLAG   dsp.I2C_A.I2CSTR              a whole register of an I2C or SCI module
           dsp.I2C_A.I2CSTR.BB           each field of the register
    IRQ    dsp.interrupt.I2CINT1A        1 from entering the service routine to leaving it
    SPAN   dsp.span.model                1 while the span lasts
           bus.I2C.busy, address, ...    state of the bus, decoded from SCL and SDA when the run is over
           bus.I2C.text, bus.UART.text   .fst only: texts of BUS records, and of the bytes of FRAME records

A file must name its signals before their changes. But the interrupts and spans of a run are known only at its end.
Therefore all changes are kept in memory until the end, at 16 bytes each.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import IO, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...core.records import Kind, Record
from ...core.registers import RegisterMap
from ...core.time import GHZ, Timebase
from ...f28335.i2c.register_map import I2C_MAP
from ...f28335.sci.register_map import SCI_MAP
from ...traces.capture.capture import Capture, Channel, changes_only, channel_of_states
from ...traces.capture.sampling import resampled
from ...traces.decode.i2c_table import I2cRowKind as Row
from ...traces.decode.i2c_table import I2cTable, i2c_table
from ...traces.formats import sigrok_sr, vcd
from ...traces.formats.fst_ghw import TEXT, Variable, fst_bytes, library
from ...traces.formats.record_table import Clocks
from ..record_text import on_the_bus
from . import BadRecording, RecordingWriter

KINDS = (Kind.EDGE, Kind.FLAG, Kind.IRQ, Kind.SPAN)
WIRES = ("SCL", "SDA", "RX", "TX")
MAPS = {"I2C": I2C_MAP, "SCI": SCI_MAP}

RATES = [Fraction(mhz * 10**6) for mhz in (100, 50, 20, 10, 5, 2, 1)]  # sample rates of .sr files, in Hz
MOST_SAMPLES = 1 << 28  # maximum number in an .sr file, 2.7 s at 100 MHz; to compress them takes 2 to 3 s
PICOSECONDS = 10**12
# SAID maps a kind of record to a signal of .fst files whose values are texts, such as "0x68 R ACK" or "0x55".
SAID = {Kind.BUS: "bus.I2C.text", Kind.FRAME: "bus.UART.text"}

Numbers = NDArray[np.int64]


class Signal:
    """A signal of `width` bits with the value `initial` at tick 0. Only the last change in a tick counts."""

    def __init__(self, name: str, width: int = 1, initial: int = 0) -> None:
        self.name = name
        self.width = width
        self.initial = initial
        self.now = initial
        self._at = array("q")
        self._values = array("q")

    def put(self, tick: int, value: int) -> None:
        if value != self.now:
            self.now = value
            self._at.append(tick)
            self._values.append(value)

    def put_all(self, at: Numbers, values: Numbers) -> None:
        """Append changes in order of time. All of them must be later than the existing changes."""
        self._at.extend(at.tolist())
        self._values.extend(values.tolist())

    def changes(self) -> tuple[Numbers, Numbers]:
        """Return (ticks, values). The ticks increase strictly from 0, and each value holds from its tick on.

        The value at tick 0 is `initial`, unless a change at tick 0 replaces it. Successive values are different.
        """
        at = np.concatenate([np.zeros(1, np.int64), np.frombuffer(self._at, np.int64)])
        values = np.concatenate([np.full(1, self.initial, np.int64), np.frombuffer(self._values, np.int64)])
        return changes_only(at, values)


class WaveformWriter(RecordingWriter):
    """Base of the waveform formats, which are written when the run is over.

    `write` adds a record to the signals of the run. `signals` returns all signals, and `bits` returns them as a capture
    with a channel for each bit. `lines` returns a capture of the signals of one bit, without fields of registers.
    """

    KINDS: ClassVar[Iterable[Kind]] = KINDS

    def __init__(self, file: IO[Any], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> None:
        super().__init__(file, timebase, modules)
        self._signals: dict[str, Signal] = {}
        self._wires = {name: self._signal(f"wires.{name}", initial=1) for name in WIRES}
        # `_fields` maps (`Record.where`, `Record.what`) of a field's changes to the field's signal, the register's
        # signal, and the field's lowest bit.
        self._fields: dict[tuple[str, str], tuple[Signal, Signal, int]] = {}
        # `_depth` maps an interrupt or span to its nesting depth, because it may be entered again before it is left.
        self._depth: dict[tuple[str, str], int] = {}
        for names in modules.values():
            for pin in (name.removeprefix("pin:") for name in names if name.startswith("pin:")):
                self._wires.setdefault(pin, self._signal(f"wires.{pin}", initial=1))
        for unit, names in modules.items():
            for name in names:
                if registers := MAPS.get(name[:3]):
                    self._registers(f"{unit}.{name}", registers)

    def write(self, record: Record) -> None:
        kind = record.kind
        if kind is Kind.EDGE:
            wire = self._wires.get(record.where)
            if wire is None:
                wire = self._wires[record.where] = self._signal(f"wires.{record.where}", initial=1 - record.value)
            wire.put(record.tick, record.value)
        elif kind is Kind.FLAG:
            found = self._fields.get((record.where, record.what))
            if found is not None:
                field, register, lsb = found
                register.put(record.tick, register.now & ~((1 << field.width) - 1 << lsb) | record.value << lsb)
                field.put(record.tick, record.value)
        elif kind in (Kind.IRQ, Kind.SPAN):
            key = record.where, f"{'interrupt' if kind is Kind.IRQ else 'span'}.{record.what}"
            depth = self._depth[key] = max(0, self._depth.get(key, 0) + (1 if record.value else -1))
            self._signal(".".join(key)).put(record.tick, int(depth > 0))

    def signals(self, end: int) -> list[Signal]:
        """Return all signals, wires first. end: the last tick of the run."""
        bus = _bus_state(capture_of([self._wires["SCL"], self._wires["SDA"]], self._per_second, end))
        wires = list(self._wires.values())
        return [*wires, *bus, *(signal for signal in self._signals.values() if signal not in wires)]

    def lines(self, end: int) -> Capture:
        """Return the signals of one bit, except fields of registers, as a logic analyser would capture them."""
        fields = {signal.name for signal, _, _ in self._fields.values()}
        lines = [s for s in self.signals(end) if s.width == 1 and s.name not in fields]
        return capture_of(lines, self._per_second, end)

    def bits(self, end: int) -> Capture:
        """Return all signals. A signal of several bits has a channel for each bit: `dsp.I2C_A.I2CSTR[12]`."""
        return capture_of(self.signals(end), self._per_second, end)

    def _signal(self, name: str, width: int = 1, initial: int = 0) -> Signal:
        found = self._signals.get(name)
        if found is None:
            found = self._signals[name] = Signal(name, width, initial)
        return found

    def _registers(self, where: str, registers: RegisterMap) -> None:
        for register in registers:
            name = f"{where}.{register.name}".replace("-", "_")
            reset = sum(f.reset << f.lsb for f in register.fields)
            whole = self._signal(name, register.width, reset)
            for f in register.fields:
                field = self._signal(f"{name}.{f.name}", f.msb - f.lsb + 1, f.reset)
                self._fields[where, f"{register.name}.{f.name}"] = field, whole, f.lsb


def capture_of(signals: Sequence[Signal], per_second: int, end: int) -> Capture:
    """Return a capture of signals, with a channel for each bit. end: the last tick of the run."""
    changes = [signal.changes() for signal in signals]
    length = max([end, *(int(at[-1]) + 1 for at, _ in changes)])
    channels: list[Channel] = []
    for signal, (at, values) in zip(signals, changes, strict=True):
        for bit in range(signal.width - 1, -1, -1):
            name = signal.name if signal.width == 1 else f"{signal.name}[{bit}]"
            levels = (values >> bit & 1).astype(np.uint8)
            channels.append(channel_of_states(name, len(channels), at, levels, length))
    return Capture(Path(), Fraction(per_second), length, tuple(channels), False, (), True)


def _bus_state(lines: Capture) -> list[Signal]:
    """Return signals of the I2C bus, decoded from SCL and SDA.

    `busy` is 1 from START to STOP. `address`, `data`, `ack` and `nack` are 1 during these parts of a transfer. `read`
    is the R/W bit of the last address. `byte` has the value of a byte from the beginning of this byte on; the value of
    an address byte includes the R/W bit.
    """
    table = i2c_table(lines, 0, 1)
    begins = table.kind == Row.START
    ends = table.kind == Row.STOP
    data = np.isin(table.kind, (Row.DATA, Row.ADDRESS_LOW))
    address = table.kind == Row.ADDRESS
    busy = Signal("bus.I2C.busy")
    busy.put_all(table.at[begins | ends], begins[begins | ends].astype(np.int64))
    read = Signal("bus.I2C.read")
    read.put_all(table.end[address], table.read[address].astype(np.int64))
    byte = Signal("bus.I2C.byte", 8)
    value = np.where(address, table.value.astype(np.int64) << 1 | table.read, table.value & 0xFF)
    byte.put_all(table.at[address | data], value[address | data])
    parts = {"address": address, "data": data, "ack": table.kind == Row.ACK, "nack": table.kind == Row.NACK}
    return [busy, *(_while(f"bus.I2C.{name}", table, rows) for name, rows in parts.items()), read, byte]


def _while(name: str, table: I2cTable, rows: NDArray[np.bool_]) -> Signal:
    """Return a signal that is 1 during the chosen rows of the table. A row is a part of a transfer, such as a byte."""
    signal = Signal(name)
    at = np.column_stack((table.at[rows], table.end[rows])).ravel()
    signal.put_all(at, np.tile(np.array([1, 0], np.int64), len(at) // 2))
    return signal


class VcdWriter(WaveformWriter):
    """VCD for GTKWave, Surfer, sigrok and scripts: wires, bus state, registers and their fields, interrupts, spans.

    Chosen:
    - Registers are written as single bits, `I2CSTR[15]` to `I2CSTR[0]`, and there are no texts. Reasons: sigrok up to
      0.5.2 reads nothing after a change of a vector, and readers such as vcdvcd find no changes of strings. `.fst` has
      vectors and texts.
    - Times are in nanoseconds, rounded up if they are not whole. At 150 MHz a tick is 1/3 ns, which is not a multiple
      of any timescale of VCD. In picoseconds, sigrok would not finish, since it makes a sample for each unit of time.
      `.psr` has exact times, and `.fst` has picoseconds.
    """

    SUFFIX = ".vcd"

    def close(self, now: int, clocks: Clocks) -> None:
        vcd.write_to(self._file, resampled(self.bits(now), Fraction(GHZ)), scope=())


class SrWriter(WaveformWriter):
    """sigrok session for PulseView and sigrok-cli: wires, bus state, interrupts and spans of the firmware.

    The file has the first 64 signals of one bit, wires first, without fields of registers. `rate_for` chooses the
    sample rate from the length of the run.
    """

    SUFFIX, MODE = ".sr", "wb"

    def close(self, now: int, clocks: Clocks) -> None:
        lines = self.lines(now)
        # The prefix "wires." is removed, because the decoders of sigrok find their channels by names such as "SCL".
        shown = [replace(c, name=c.name.removeprefix("wires.")) for c in lines.channels[: sigrok_sr.MOST_WIDE]]
        rate = rate_for(Fraction(lines.length, self._per_second))
        sigrok_sr.write_to(self._file, resampled(replace(lines, channels=tuple(shown)), rate))


def rate_for(seconds: Fraction) -> Fraction:
    """Return the sample rate of an .sr file for a run of this length, in Hz.

    It is the highest of RATES with at most MOST_SAMPLES samples; if there is none, the lowest of RATES.
    """
    return next((rate for rate in RATES if seconds * rate <= MOST_SAMPLES), RATES[-1])


class FstWriter(WaveformWriter):
    """FST for GTKWave and Surfer: registers as vectors, and the bytes on bus and UART as text.

    The file is small and quick to open. The library that writes it is installed with `periph_sim[fst]`. Times are in
    picoseconds, rounded down.
    """

    SUFFIX, MODE = ".fst", "wb"
    KINDS = (*KINDS, *SAID)

    def __init__(self, file: IO[bytes], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> None:
        try:
            library()  # if the library is missing, the error is raised before the run
        except ImportError as error:
            raise BadRecording(str(error)) from None
        super().__init__(file, timebase, modules)
        self._said: dict[str, list[tuple[int, str]]] = {name: [(0, "-")] for name in SAID.values()}

    def write(self, record: Record) -> None:
        if record.kind not in SAID:
            super().write(record)
        elif record.kind is Kind.BUS or record.what == "byte":
            self._said[SAID[record.kind]].append((self._time(record.tick), on_the_bus(record)))

    def close(self, now: int, clocks: Clocks) -> None:
        variables = [self._variable(signal) for signal in self.signals(now)]
        variables += [Variable(name, TEXT, said) for name, said in self._said.items()]
        self._file.write(fst_bytes(Fraction(PICOSECONDS), variables, self._time(now)))

    def _variable(self, signal: Signal) -> Variable:
        at, values = signal.changes()
        letters = (f"{value:0{signal.width}b}" for value in values.tolist())
        return Variable(signal.name, signal.width, zip(map(self._time, at.tolist()), letters, strict=True))

    def _time(self, tick: int) -> int:
        return tick * PICOSECONDS // self._per_second


FORMATS = (VcdWriter, SrWriter, FstWriter)

"""A run as tracks for ui.perfetto.dev or chrome://tracing, as JSON in the Trace Event Format.

    records --> process "dsp":        threads "firmware" and "interrupts" with nested slices; thread "notes"
                process "dsp.I2C-A":  a counter for each register field that changed
                process "bus":        transfers with their bytes, decoded from SCL and SDA;
                                      BUS and FRAME records of each party
                process "wires":      a counter for each wire that changed, 0 or 1

`ts` is in microseconds with three decimals, rounded down to a nanosecond, the resolution of the viewers. `args.tick` of
slices and instants is the exact time in ticks, and `otherData.ticks_per_second` is the number of ticks per second.
Counters have no argument `tick`, since a viewer would draw it as another counter.

Source: Trace Event Format (Google, 2016), sections on duration, instant, counter and metadata events.
"""

from __future__ import annotations

import json
from typing import IO

from ...core.phrases import addressed
from ...core.records import Kind, Record
from ...core.time import GHZ, Timebase
from ...traces.decode import i2c
from ...traces.formats.record_table import Clocks
from ..record_text import BusByte, on_the_bus
from . import RecordingWriter
from .waveforms import Signal, capture_of

THREAD_OF = {Kind.SPAN: "firmware", Kind.IRQ: "interrupts"}


class Track:
    """One thread in the viewer. The slices of a thread can be nested."""

    def __init__(self, pid: int, tid: int) -> None:
        self.head = f'"pid":{pid},"tid":{tid}'
        self.open: list[str] = []  # JSON-encoded names of the slices that have not ended


class PerfettoWriter(RecordingWriter):
    SUFFIX = ".perfetto.json"
    KINDS = (Kind.EDGE, Kind.FLAG, Kind.IRQ, Kind.SPAN, Kind.BUS, Kind.FRAME, Kind.NOTE)

    def __init__(self, file: IO[str], timebase: Timebase, modules: dict[str, tuple[str, ...]]) -> None:
        super().__init__(file, timebase, modules)
        self._separator = ""
        self._pids: dict[str, int] = {}
        self._tracks: dict[tuple[str, str], Track] = {}
        self._counters: dict[tuple[str, str], str] = {}
        self._bus = {name: Signal(name, initial=1) for name in ("SCL", "SDA")}
        head = {"displayTimeUnit": "ns", "otherData": {"by": "periph-sim", "ticks_per_second": str(self._per_second)}}
        file.write(json.dumps(head)[:-1] + ', "traceEvents": [\n')
        for unit in modules:
            for thread in THREAD_OF.values():
                self._track(unit, thread)

    def write(self, record: Record) -> None:
        kind = record.kind
        if kind is Kind.EDGE:
            self._counter("wires", record.where, record.tick, record.value)
            if record.where in self._bus:
                self._bus[record.where].put(record.tick, record.value)
        elif kind is Kind.FLAG:
            self._counter(record.where, record.what, record.tick, record.value)
        elif kind in THREAD_OF:
            track = self._track(record.where, THREAD_OF[kind])
            if record.value:
                self._begin(track, record.what, record.tick)
            elif track.open:
                self._end(track, record.tick)
        else:
            place, thread = (record.where, "notes") if kind is Kind.NOTE else ("bus", record.where)
            self._instant(self._track(place, thread), record)

    def close(self, now: int, clocks: Clocks) -> None:
        for track in self._tracks.values():
            while track.open:
                self._end(track, now)
        self._transfers(now)
        self._file.write("\n]}\n")

    def _transfers(self, now: int) -> None:
        """Write the transfers and bytes that the decoder of captures finds on SCL and SDA up to the tick `now`."""
        capture = capture_of([*self._bus.values()], self._per_second, now + 1)
        if not all(len(channel.edges) for channel in capture.channels):
            return
        track = self._track("bus", "transfers")
        for transfer in i2c.transfers(capture):
            if not transfer.phases:  # the START came before the recording began
                continue
            self._begin(track, _title(transfer), transfer.phases[0].start.at)
            for place, byte in ((place, byte) for phase in transfer.phases for place, byte in enumerate(phase.bytes)):
                self._begin(track, _byte(byte, place), byte.at)
                last = byte.bits[-1]
                self._end(track, now if last.high is None else last.at + last.high)
            self._end(track, transfer.stop.at if transfer.stop else now)

    def _pid(self, process: str) -> int:
        if process not in self._pids:
            self._pids[process] = pid = len(self._pids) + 1
            self._event(f'"ph":"M","name":"process_name","pid":{pid},"tid":0,"args":{{"name":{json.dumps(process)}}}')
        return self._pids[process]

    def _track(self, process: str, thread: str) -> Track:
        track = self._tracks.get((process, thread))
        if track is None:
            tid = len(self._tracks) + 1
            track = self._tracks[process, thread] = Track(self._pid(process), tid)
            self._event(f'"ph":"M","name":"thread_name",{track.head},"args":{{"name":{json.dumps(thread)}}}')
        return track

    def _counter(self, process: str, name: str, tick: int, value: int) -> None:
        head = self._counters.get((process, name))
        if head is None:
            pid = self._pid(process)
            head = self._counters[process, name] = f'"ph":"C","name":{json.dumps(name)},"pid":{pid},"tid":0'
        self._event(f'{head},"ts":{self._ts(tick)},"args":{{"value":{value}}}')

    def _begin(self, track: Track, name: str, tick: int) -> None:
        track.open.append(json.dumps(name))
        self._slice("B", track, track.open[-1], tick)

    def _end(self, track: Track, tick: int) -> None:
        self._slice("E", track, track.open.pop(), tick)

    def _slice(self, phase: str, track: Track, name: str, tick: int) -> None:
        self._event(f'"ph":"{phase}","name":{name},{track.head},"ts":{self._ts(tick)},"args":{{"tick":{tick}}}')

    def _instant(self, track: Track, record: Record) -> None:
        about: dict[str, int | str] = {"tick": record.tick}
        name = record.what
        if record.kind is Kind.NOTE:
            about["value"] = record.value
        else:
            name = f"{on_the_bus(record)} {record.text}".strip()
        if record.text:
            about["text"] = record.text
        ts, args = self._ts(record.tick), json.dumps(about)
        self._event(f'"ph":"i","s":"t","name":{json.dumps(name)},{track.head},"ts":{ts},"args":{args}')

    def _ts(self, tick: int) -> str:
        ns = tick * GHZ // self._per_second
        return f"{ns // 1000}.{ns % 1000:03}"

    def _event(self, inside: str) -> None:
        self._file.write(f"{self._separator}{{{inside}}}")
        self._separator = ",\n"


def _title(transfer: i2c.Transfer) -> str:
    """Return the title of a transfer, such as `0x68 W 0x68 R`; "cut off" if it has no complete address."""
    named = (addressed(one.address, bool(one.read)) for one in transfer.phases if one.address is not None)
    return " ".join(named) or "cut off"


def _byte(byte: i2c.Byte, place: int) -> str:
    """Return a byte as text: `0x68 W ACK` for the first byte after a START, `0x1D ACK` for other bytes.

    For a byte that is cut off, the text has the received bits instead of a value. A byte without a
    ninth bit is shown whole, as `0xD0 no ninth bit`.

    place: the number of bytes between the START and this byte; 0 for the address byte.
    """
    if byte.value is None:
        return "cut off: " + "".join(str(bit.value) for bit in byte.bits)
    if byte.acked is None:
        return f"0x{byte.value:02X} no ninth bit"
    if place:
        return str(BusByte(byte.value, byte.acked))
    return str(BusByte(byte.value >> 1, byte.acked, bool(byte.value & 1)))


FORMATS = (PerfettoWriter,)

"""Runs of a unit whose firmware and bus partners are short scripts. A run returns its records and assumed options.

    "I2CMDR=20 ~RRDY I2CDRR" --> firmware --> Dsp <-- wires <-- partners of tests/f28335/i2c_bus.py
    image source             --> program  --'             '---- levels of RXD, or of the pins of the SPI

Words of a firmware script: REGISTER=hex writes, REGISTER reads, +n computes for n cycles, ~FLAG waits for a flag of
I2CSTR, or for TIF of TIMER0. HALT=1 and HALT=0 stop and resume the CPU as a debugger does; only the first module of the
scene is notified.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import groupby
from typing import NamedTuple

from periph_sim.bus.edge_player import EdgePlayer
from periph_sim.core.kernel import Kernel
from periph_sim.core.options import Answers, Value, options_from
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.sampler import watch
from periph_sim.core.time import Timebase
from periph_sim.core.wire import Pin, Wire
from periph_sim.f28335.cpu.code_costs import BARE
from periph_sim.f28335.i2c.options import I2cOptions
from periph_sim.f28335.parts.f28335 import PART
from periph_sim.f28335.sci.options import SciOptions
from periph_sim.f28335.spi.options import SpiOptions
from periph_sim.f28335.system_options import SystemOptions
from periph_sim.firmware import start_pie
from periph_sim.processor.dsp import Dsp, DspPlan
from periph_sim.processor.image_files.assemble import assemble
from tests.f28335.i2c_bus import RELEASED, SCL, SDA, Party
from tests.f28335.i2c_registers import FLAGS

KINDS: dict[str, type[Answers]] = {"i2c": I2cOptions, "sci": SciOptions, "spi": SpiOptions, "system": SystemOptions}
SIGNALS = ("SCLA", "SDAA", "SCIRXDA", "SCITXDA")
SPI_SIGNALS = ("SPISIMOA", "SPISOMIA", "SPICLKA", "SPISTEA")
CYCLE = 20  # ticks at 150 MHz
START = 4000  # cycles after which partners begin
RXD_START = 4032  # and levels: a cycle less in the synchroniser moves the first edge before a sample
SAMPLE = 100  # cycles of a sample on RXD, an SCICLK; a bit has eight


class Scene(NamedTuple):
    """A scene of one unit.

    firmware: a script. source: the source of an image, instead of firmware.
    service: vector -> script of its service routine.
    partners: creates the other parties on the I2C bus.
    levels: of signals that other chips drive, one a sample; the last one stays.
    answers: to options by group and name, if the scene needs others than the defaults.
    """

    firmware: str = ""
    modules: tuple[str, ...] = ()
    source: str = ""
    service: dict[str, str] = {}
    partners: Callable[[], Iterable[Party]] = list
    levels: dict[str, str] = {}
    cycles: int = 60_000
    answers: dict[str, dict[str, Value]] = {}


class Outcome(NamedTuple):
    records: list[Record]
    assumed: set[str]


def run(scene: Scene, group: str = "i2c", **answers: Value) -> Outcome:
    """Run a scene. answers: to options of this group. Flags are not recorded: they change without being read."""
    kernel, recorder, records = Kernel(), Recorder(), list[Record]()
    recorder.subscribe(set(Kind) - {Kind.FLAG}, records.append)
    signals = SIGNALS + SPI_SIGNALS * ("SPI-A" in scene.modules)
    wires = {name: Wire(kernel, name, recorder) for name in signals}
    given = scene.answers | {group: scene.answers.get(group, {}) | answers}
    options = {name: options_from(kind, given.get(name, {})) for name, kind in KINDS.items()}
    pins = {PART.pins[name]: wire for name, wire in wires.items()}
    system = options["system"]
    assert isinstance(system, SystemOptions)
    plan = DspPlan("dsp", scene.modules, pins, from_boot=bool(scene.source), code=BARE, system=system, options=options)
    dsp = Dsp(kernel, Timebase(150_000_000), recorder, plan)
    for party in scene.partners():
        OnWires(kernel, (wires["SCLA"], wires["SDAA"]), party)
    for signal, samples in scene.levels.items():
        EdgePlayer(kernel, wires[signal], edges_of(samples))
    if scene.source:
        dsp.start_image(assemble(scene.source))
    else:
        dsp.start(Firmware(dsp, scene).main)
    kernel.run_until(kernel.now + scene.cycles * CYCLE)
    return Outcome(records, dsp.touched)


class Firmware:
    """Python firmware that executes the scripts of a scene."""

    def __init__(self, dsp: Dsp, scene: Scene) -> None:
        self._dsp, self._scene = dsp, scene
        self._module_of = {register.name: name for name, socket in dsp.sockets.items() for register in socket.chip.MAP}

    def main(self) -> None:
        self._dsp.eallow()
        if self._scene.service:
            start_pie(self._dsp, {vector: self._routine(text) for vector, text in self._scene.service.items()})
        self._do(self._scene.firmware)

    def _routine(self, text: str) -> Callable[[], None]:
        return lambda: self._do(text)

    def _do(self, text: str) -> None:
        dsp = self._dsp
        for word in text.split():
            name, writes, value = word.partition("=")
            if name == "HALT":
                socket = dsp.sockets[self._scene.modules[0]]
                socket.chip.suspend(dsp.cpu.cycle, value == "1")
                socket.publish(dsp.cpu.cycle)
            elif name.startswith("+"):
                dsp.compute(int(name))
            elif name.startswith("~"):
                self._wait(name[1:])
            elif writes:
                dsp.module(self._module_of[name])[name].all = int(value, 16)
            else:
                assert dsp.module(self._module_of[name])[name].all is not None

    def _wait(self, flag: str) -> None:
        dsp = self._dsp
        if flag == "TIF":
            dsp.spin(lambda: dsp.module("TIMER0").TCR.TIF)
        else:
            dsp.spin(lambda: dsp.module("I2C-A").I2CSTR.all & FLAGS[flag])


class OnWires:
    """A partner of the test bus, which counts cycles, on the wires of a kernel."""

    def __init__(self, kernel: Kernel, wires: tuple[Wire, Wire], party: Party) -> None:
        self._kernel, self._wires, self._party = kernel, wires, party
        self._pins: list[Pin] = [wire.attach("partner") for wire in wires]
        self._began = kernel.now
        self._levels = self._out = RELEASED
        for wire in wires:
            watch([wire], self._changed)
        self._follow()

    @property
    def _now(self) -> int:
        return (self._kernel.now - self._began) // CYCLE

    def _changed(self, tick: int, level: int) -> None:
        self._kernel.call_at(tick, self._moved)

    def _moved(self) -> None:
        levels = self._wires[SCL].level | self._wires[SDA].level << 1
        if levels != self._levels:
            self._levels = levels
            self._party.pins(self._now, levels)
            self._follow()

    def _wake(self) -> None:
        if self._party.next_wake <= self._now:
            self._party.wake(self._now)
            self._follow()

    def _follow(self) -> None:
        changed, self._out = self._out ^ self._party.out, self._party.out
        for line in (SCL, SDA):
            if changed >> line & 1:
                self._pins[line].drive(self._out >> line & 1)
        if self._party.next_wake < 1 << 40:
            self._kernel.call_at(self._began + max(self._party.next_wake, self._now) * CYCLE, self._wake)


def edges_of(samples: str) -> list[tuple[int, int]]:
    """Return (tick, level) of the edges of a signal that is high before."""
    edges, time, before = [], RXD_START * CYCLE, "1"
    for level, run_of in groupby(samples):
        if level != before:
            edges.append((time, int(level)))
        time += SAMPLE * CYCLE * len(list(run_of))
        before = level
    return edges

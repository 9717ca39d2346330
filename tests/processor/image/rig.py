"""A unit that runs a program in assembly, with its CPU, memory, records and notes."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from periph_sim.core.kernel import Kernel
from periph_sim.core.options import Value, options_from
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.f28335.descriptor import Part
from periph_sim.f28335.parts.f28335 import PART
from periph_sim.f28335.system_options import SystemOptions
from periph_sim.processor.dsp import Dsp, DspPlan
from periph_sim.processor.image.boot import Boot, Stub
from periph_sim.processor.image.program import ImageProgram
from periph_sim.processor.image_files.assemble import assemble
from periph_sim.processor.image_files.model import Image

HEAD = """
WDCR .set 0x7029
TCR .set 0x0C04
COUNT .set 0x9100
 .sect ".text", 0x9000
 .global _c_int00
_c_int00: EALLOW
 MOVW DP,#WDCR >> 6
 MOV @WDCR,#0x68
 EDIS
"""
VECTOR = """
 MOVL XAR4,#_routine
 EALLOW
 MOVL XAR5,#0x0D4C
 MOVL *XAR5,XAR4
 EDIS
"""
ENPIE = " MOVW DP,#0x0CE0 >> 6\n MOV @0x0CE0,#1\n"


def timer(cycles: int) -> str:
    """Return assembly for after HEAD: timer 0 requests TINT0, whose routine is _routine, with a period in cycles."""
    return f"""{VECTOR}
 MOVW DP,#0x0CE0 >> 6
 MOV @0x0CE0,#1
 MOV @0x0CE2,#0x40
 MOVW DP,#0x0C00 >> 6
 MOVL XAR6,#{cycles - 1}
 MOVL @0x0C02,XAR6
 MOV @TCR,#0x4020
 OR IER,#1
"""


class Rig:
    """A unit that runs a program, given as an image or as source, from its entry; `run` takes 2 ms by default."""

    def __init__(
        self,
        source: str | Image,
        *modules: str,
        boot: Boot = "entry",
        stubs: Iterable[Stub] = (),
        skip: bool = True,
        part: Part = PART,
        **options: Value,
    ) -> None:
        self.kernel, self.recorder = Kernel(), Recorder()
        self.records: list[Record] = []
        self.recorder.subscribe({Kind.IRQ, Kind.NOTE, Kind.ACCESS}, self.records.append)
        system = options_from(SystemOptions, options)
        plan = DspPlan("dsp", modules, {}, from_boot=True, skip_polls=skip, system=system, part=part)
        self.dsp = Dsp(self.kernel, Timebase(150_000_000), self.recorder, plan)
        image = assemble(source) if isinstance(source, str) else source
        self.dsp.start_image(image, boot, stubs)
        assert isinstance(self.dsp.program, ImageProgram)
        self.program = self.dsp.program
        self.cpu = self.program.cpu

    def run(self, ticks: int = 6_000_000) -> Rig:
        self.kernel.run_until(self.kernel.now + ticks)
        return self

    def record_waits(self) -> list[Record]:
        """Return the list to which the unit's WAIT records will be added."""
        waits: list[Record] = []
        self.recorder.subscribe({Kind.WAIT}, waits.append)
        self.program.record_waits(self.recorder)
        return waits

    def word(self, address: int) -> int:
        return self.dsp.processor.bus.ram.word(address)

    def notes(self) -> list[str]:
        return [note.text for note in self.dsp.processor.notes.counts]


def ended(source: str | Image, **options: Any) -> int:
    """Return the cycle in which a program reaches ESTOP0; the options are those of `Rig`."""
    at = Rig(source, **options).run().program.returned_at
    assert at is not None
    return at

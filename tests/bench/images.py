"""`make bench`, firmware in machine code: instructions a second of a busy program, in both forms. Nothing is asserted.

Arithmetic, calls, RPT and FPU, all from RAM, stalls counted, nothing recorded; a program that only waits is another
matter, its polls are skipped.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from statistics import median
from time import process_time
from typing import Any

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.time import Timebase
from periph_sim.form import COMPILED
from periph_sim.image.assemble import assemble
from periph_sim.processor.dsp import Dsp, DspPlan
from periph_sim.processor.image.program import ImageProgram

from .child import in_form

Row = dict[str, Any]
TICKS = {True: 2_400_000_000, False: 30_000_000}  # compiled, or not
BUSY = """
 .sect ".text", 0x9000
 .global _c_int00
_c_int00: EALLOW
 MOVW DP,#0x7029 >> 6
 MOV @0x7029,#0x68
 EDIS
 MOVL XAR4,#0xA000
 MOVL XAR5,#0xA100
 MOVIZ R0H,#0x3F80
 MOVIZ R1H,#0x3F81
 ZERO R2H
loop: MOVB XAR3,#31
inner: MOVL ACC,*XAR4
 ADD ACC,#5<<#2
 MOVL *XAR4,ACC
 MOV AL,*XAR5
 ADDB AL,#1
 MOV *XAR5,AL
 LCR #_f
 MPYF32 R2H,R2H,R1H
 NOP
 ADDF32 R2H,R2H,R0H
 NOP
 MOV32 *XAR5,R2H
 BANZ inner,AR3--
 MOVL XAR6,#0xA200
 ZAPA
 RPT #15 || MAC P,*XAR6++,0:0xA200
 ADDL ACC,P<<PM
 SB loop,UNC
 .global _f
_f: ADDB SP,#2
 MOVL *-SP[2],ACC
 MOV T,*-SP[2]
 MPY ACC,T,*XAR4
 LSL ACC,#3
 SUBB SP,#2
 LRETR
"""


def busy(ticks: int) -> dict[str, float]:
    """Instructions, and the CPU seconds that they took."""
    kernel = Kernel()
    dsp = Dsp(kernel, Timebase(150_000_000), Recorder(), DspPlan("dsp", (), {}, from_boot=True))
    dsp.start_image(assemble(BUSY))
    program = dsp.program
    assert isinstance(program, ImageProgram)
    kernel.run_until(ticks // 100)  # all of it is decoded
    before, began = program.instructions, process_time()
    kernel.run_until(ticks)
    return {"instructions": program.instructions - before, "seconds": process_time() - began}


def rows(forms: Sequence[str], repeat: int) -> Iterator[Row]:
    for form in forms:
        runs = [in_form(form, "images", "busy", TICKS[form == COMPILED]) for _ in range(repeat)]
        speed = median(run["instructions"] / run["seconds"] for run in runs)
        yield {"program": "busy", "form": form, "instructions_per_s": round(speed)}


def line(row: Row) -> str:
    return f"{row['program']}, {row['form']}: {row['instructions_per_s'] / 1e6:.2f} M instructions a second"

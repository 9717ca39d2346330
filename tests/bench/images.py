"""`make bench`, firmware in machine code, both forms: speed of a busy program, CPU time of programs that mostly wait.

    busy            arithmetic, calls, RPT and FPU from RAM; with stalls and wait states, without records
    SCI echo        firmware/c28x/sci_echo.asm, 250 ms from reset, with characters back to back and with gaps
    imu_hil_image   the shipped case, CPU time per simulated second after its start

No time is asserted; an echo that loses a character is an error.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from statistics import median
from time import process_time
from typing import Any

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.form import COMPILED
from periph_sim.processor.dsp import Dsp, DspPlan
from periph_sim.processor.image.program import ImageProgram
from periph_sim.processor.image_files.assemble import SHIPPED, assemble
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import Case
from periph_sim.scene.scene import Scene

from .child import TIMING, in_form
from .levels import START
from .timed import timed

Row = dict[str, Any]
BACK_TO_BACK, WITH_GAPS = "SCI echo, back to back", "SCI echo, gaps of 300 us"
GAPS = {BACK_TO_BACK: "0 s", WITH_GAPS: "300 us"}
ECHO_FROM, ECHO_UNTIL = Fraction(6, 1000), Fraction(1, 4)  # the PLL locks in 4.4 ms
BAUD = 114_329  # the firmware's rate, 37.5 MHz / 8 / 41; 115200 would overrun it after a while
CHARACTER = Fraction(10, BAUD)
IMU_HIL = "imu_hil_image"
UNTIL = {True: "1.1", False: "0.3"}  # seconds of scene, by whether the form is compiled
TICKS = {True: 2_400_000_000, False: 30_000_000}  # by whether the form is compiled
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
    """Return the number of executed instructions and their CPU seconds."""
    kernel = Kernel()
    dsp = Dsp(kernel, Timebase(150_000_000), Recorder(), DspPlan("dsp", (), {}, from_boot=True))
    dsp.start_image(assemble(BUSY))
    program = dsp.program
    assert isinstance(program, ImageProgram)
    kernel.run_until(ticks // 100)  # the whole program is decoded by then
    before, began = program.instructions, process_time()
    kernel.run_until(ticks)
    return {"instructions": program.instructions - before, "seconds": process_time() - began}


def busy_speed(ticks: int) -> float:
    """Return the instructions per CPU second."""
    run = busy(ticks)
    return run["instructions"] / run["seconds"]


def echo(gap: str, until: str = str(ECHO_UNTIL)) -> float:
    """Return the CPU seconds of a run from reset to `until`, in which characters arrive all the time and are echoed."""
    pause = Fraction(gap.split()[0]) / 1_000_000
    count = int((Fraction(until) - ECHO_FROM) / (CHARACTER + pause)) - 2  # the last ones are echoed before the end
    sent = bytes(number & 0xFF for number in range(count))
    send = {"name": "text", "to": "dsp.SCI-A", "bytes": sent.hex(" "), "at": "6 ms", "gap": gap, "baud": BAUD}
    unit = {"image": str(SHIPPED / "sci_echo.asm"), "modules": ["SCI-A", "GPIO"]}
    tables = {"name": "echo", "duration": f"{until} s", "unit": {"dsp": unit}, "serial": {"send": [send]}}
    text: list[Record] = []
    scene = Scene(Case.model_validate(tables), lambda recorder, _: recorder.subscribe([Kind.FRAME], text.append))
    _, time = timed(lambda: scene.run(Fraction(until)))
    result = bytes(one.value & 0xFF for one in text if (one.where, one.what) == ("TX", "end"))
    if result != sent:
        raise RuntimeError(f"{count} characters were sent with gaps of {gap}; {len(result)} came back, or others")
    return time.cpu


def imu_hil(until: str) -> float:
    """Return the CPU seconds per simulated second of imu_hil_image after its start."""
    scene = Scene(load(TIMING / f"{IMU_HIL}.toml"))
    scene.advance(scene.start + scene.timebase.ticks(START, "nearest"))
    _, time = timed(lambda: scene.run(Fraction(until)))
    return time.cpu / float(Fraction(until) - START)


def rows(forms: Sequence[str], repeat: int) -> Iterator[Row]:
    for form in forms:

        def middle(function: str, *arguments: object, form: str = form) -> float:
            return median(in_form(form, "images", function, *arguments) for _ in range(repeat))

        yield {
            "program": "busy",
            "form": form,
            "instructions_per_s": round(middle("busy_speed", TICKS[form == COMPILED])),
        }
        for name, gap in GAPS.items():
            yield {"program": name, "form": form, "cpu_s": middle("echo", gap)}
        yield {"program": IMU_HIL, "form": form, "cpu_s_per_s": middle("imu_hil", UNTIL[form == COMPILED])}


def line(row: Row) -> str:
    if "cpu_s" in row:
        how = f"{row['cpu_s']:.3f} s of CPU for 250 ms"
    elif "cpu_s_per_s" in row:
        how = f"{row['cpu_s_per_s']:.3f} s of CPU per simulated second"
    else:
        how = f"{row['instructions_per_s'] / 1e6:.2f} M instructions per second"
    return f"{row['program']}, {row['form']}: {how}"

"""What a loop of Python that polls a register pass by pass costs: seconds of CPU time for one simulated second.

python -m tests.bench.plain_polling    prints it for the form that runs; the goal is less than 10 s, compiled
"""

from __future__ import annotations

from fractions import Fraction
from time import process_time

from periph_sim import form
from periph_sim.processor.user_code import output_muted
from periph_sim.scene.case.model import Case
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.scene import Scene

LENGTH = Fraction(1, 10)


def polls(dsp, settings) -> None:  # type: ignore[no-untyped-def]
    i2c = dsp.module("I2C-A")
    while i2c.I2CSTR.AAS == 0:
        pass


def seconds() -> float:
    """CPU time for each simulated second."""
    unit = {"dsp": {"firmware": "polls", "modules": ["I2C-A"]}}
    case = Case.model_validate({"name": "polls", "duration": LENGTH, "unit": unit})
    scene = Scene(case, None, {"dsp": Firmware("polls", polls, None)})
    began = process_time()
    with output_muted():
        scene.run()
    return (process_time() - began) / float(LENGTH)


if __name__ == "__main__":
    print(f"{form.running}: {seconds():.1f} s of CPU time for one simulated second of plain polling")

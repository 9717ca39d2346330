"""Misuse of the DSP by firmware: one sentence with file and line, and no traceback."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from periph_sim import BadCase, Case, FirmwareError, Scene, load
from periph_sim.core.time import seconds
from tests.scene.small import sentence_of

CASE = """\
name = "small"
duration = "1 ms"

[unit.dsp]
firmware = "{firmware}"
modules = ["I2C-A", "GPIO", "TIMER0"]
"""


def scene_of(folder: Path, text: str) -> Scene:
    firmware = folder / "wrong.py"
    firmware.write_text(text, encoding="utf-8")
    case = folder / "small.toml"
    case.write_text(CASE.format(firmware=firmware), encoding="utf-8")
    return Scene(load(case))


STATEMENTS = {
    "dsp.spin(i2c.I2CSTR.BB == 1)": "dsp.spin needs a function to call in each pass, but got False; write",
    "dsp.spin_either(lambda: 0, True)": "dsp.spin_either needs a function to call in each pass, but got True",
    "dsp.spin(lambda: 1, pass_cycles=0)": "pass_cycles is 0; expected a whole number of cycles above 0",
    "dsp.spin(lambda: 1, timeout=1e-3)": "a time of 0.001 is not an exact number; expected whole cycles, or seconds as",
    "i2c.I2CDXR.all = 0x1FFFF": "I2C-A.I2CDXR = 0x1ffff: expected 0 to 0xffff; cut it as C would, with & 0xffff",
    "i2c.I2CDXR.all = -1": "I2C-A.I2CDXR = -0x1: expected 0 to 0xffff",
    "i2c.I2CDXR.all = 1.0": "I2C-A.I2CDXR = 1.0: expected a whole number from 0 to 0xffff",
    "i2c.I2CMDR.BC = 8": "I2C-A.I2CMDR.BC = 0x8: expected 0 to 0x7",
    "i2c.I2CMDR.IRS = None": "I2C-A.I2CMDR.IRS = None: expected a whole number from 0 to 0x1",
    "dsp.module('TIMER0').PRD.all = 1 << 32": "TIMER0.PRD = 0x100000000: expected 0 to 0xffffffff",
    "dsp.module('TIMER0').PRD.half.MSW = 1 << 16": "TIMER0.PRD.half.MSW = 0x10000: expected 0 to 0xffff",
    "dsp.compute(-1)": "a time of -1 cycles is negative; expected 0 or more",
    "dsp.compute(1 << 70)": f"a time of {1 << 70} cycles exceeds the longest possible run, of",
    "dsp.spin(lambda: 0, timeout=1 << 70)": f"a time of {1 << 70} cycles exceeds the longest possible run, of",
    "dsp.spin(lambda: 0, pass_cycles=1 << 70)": f"dsp.spin: pass_cycles = {1 << 70} exceeds the longest possible run",
    "dsp.compute(2.5)": "a time of 2.5 is not an exact number",
    "dsp.span(7)": "dsp.span needs the name of the span, but got 7",
    "dsp.handle('RESET', lambda: None)": "the vector 'RESET' is in boot ROM, so it takes no routine",
    "dsp.handle('XINT1', None)": "the routine of 'XINT1' is None; give the function itself, without calling it",
    "dsp.handle('XINT1', lambda x: 0)": "the routine of 'XINT1' takes (x); a service routine is a plain function",
}


@pytest.mark.parametrize("statement", STATEMENTS)
def test_wrong_use_is_reported_with_file_and_line(tmp_path: Path, statement: str):
    text = f"def main(dsp, settings):\n    i2c = dsp.module('I2C-A')\n    {statement}\n"
    message = sentence_of(FirmwareError, lambda: scene_of(tmp_path, text).run())
    assert message.startswith("dsp, line 3 of wrong.py: ") and STATEMENTS[statement] in message


def test_whole_numbers_of_other_types_are_accepted(tmp_path: Path):
    text = (
        "import numpy as np\n\ndef main(dsp, settings):\n    i2c = dsp.module('I2C-A')\n"
        "    dsp.eallow()\n    dsp.module('SYS').PCLKCR0.all = np.uint16(16)\n    dsp.edis()\n"
        "    dsp.compute(np.int64(50))\n    i2c.I2CMDR.IRS = True\n    i2c.I2COAR.all = np.int16(0x68)\n"
    )
    scene = scene_of(tmp_path, text)
    scene.run()
    assert scene.measured.value_of("dsp.I2C-A", "I2COAR.OAR") == np.int16(0x68)


MAINS = {
    "def main(dsp):\n    pass\n": "main takes (dsp); expected a plain function main(dsp, settings)",
    "def main(dsp, settings, more):\n    pass\n": "main takes (dsp, settings, more)",
    "async def main(dsp, settings):\n    pass\n": "main is async",
    "def main(dsp, settings):\n    yield\n": "main is a generator (it has a yield), so calling it runs nothing",
}


@pytest.mark.parametrize("text", MAINS)
def test_a_main_that_cannot_be_called_is_refused_before_the_run(tmp_path: Path, text: str):
    message = sentence_of(BadCase, lambda: scene_of(tmp_path, text))
    assert "line 5: unit.dsp.firmware: " in message
    assert "wrong.py', line 1 of wrong.py: " in message and MAINS[text] in message


@pytest.mark.parametrize("how", ["async def irq():\n    pass\n", "def irq():\n    yield\n"])
def test_a_service_routine_that_would_not_run_is_refused(tmp_path: Path, how: str):
    text = f"{how}def main(dsp, settings):\n    dsp.handle('XINT1', irq)\n"
    with pytest.raises(FirmwareError, match=r"dsp, line 4 of wrong\.py: the routine of 'XINT1' is "):
        scene_of(tmp_path, text).run()


def test_an_empty_case_is_refused():
    with pytest.raises(BadCase, match="there is nothing to run; give it a"):
        Scene(Case.model_validate({"name": "empty", "duration": "1 ms"}))


def test_a_case_without_budgets_is_not_judged(tmp_path: Path):
    result = scene_of(tmp_path, "def main(dsp, settings):\n    dsp.compute(5)\n").run()
    assert (result.verdict, result.budgets) == ("not judged", [])


@pytest.mark.parametrize(("wait", "noted"), [("compute(180_000)", True), ("spin(lambda: 0)", False)])
def test_a_main_that_returns_before_the_end_is_noted_with_its_time(tmp_path: Path, wait: str, noted: bool):
    scene = scene_of(tmp_path, f"def main(dsp, settings):\n    dsp.{wait}\n")
    notes = scene.run(seconds("2 ms")).notes
    at = "dsp: main returned at 1200.000 us; from then on only service routines run"
    assert notes == ([at] if noted else [])


# Exceptions by their origin ------------------------------------------------------------------


SERVICE_ROUTINE = (
    "def tick(dsp):\n    dsp.compute(-3)\n\n\ndef main(dsp, settings):\n"
    "    from periph_sim.firmware import start_pie\n    timer = dsp.module('TIMER0')\n"
    "    timer.PRD.all = 1000\n    timer.TCR.all = 0x4020\n    start_pie(dsp, {'TINT0': lambda: tick(dsp)})\n"
    "    dsp.compute(100_000)\n"
)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "def main(dsp, settings):\n    dsp.compute(5)\n    return 5\n",
            r"dsp: main, line 1 of wrong\.py, returned 5; firmware returns nothing",
        ),
        (SERVICE_ROUTINE, r"dsp, line 2 of wrong\.py: a time of -3 cycles is negative"),
        (
            "def half(x):\n    return x / 0\n\n\ndef main(dsp, settings):\n    half(1)\n",
            r"dsp: ZeroDivisionError at line 2 of wrong\.py: division by zero",
        ),
        (
            "def main(dsp, settings):\n    dsp.module('I2C-A').I2CMRD.all = 0\n",
            r"dsp: AttributeError at line 2 of wrong\.py: I2C-A has no register 'I2CMRD'",
        ),
    ],
    ids=["main returns a value", "misuse in a service routine", "exception", "wrong name"],
)
def test_an_error_in_the_firmware_ends_the_run_with_its_line(tmp_path: Path, text: str, message: str):
    scene = scene_of(tmp_path, text)
    with pytest.raises(FirmwareError, match=message):
        scene.run()


def test_an_exception_of_a_model_is_not_reported_as_one_of_the_firmware(tmp_path: Path):
    scene = scene_of(tmp_path, "def main(dsp, settings):\n    dsp.module('I2C-A').I2COAR.all = 1\n")
    scene.units["dsp"].sockets["I2C-A"].after = lambda cycle: seconds(3)  # raises in a file of periph_sim
    with pytest.raises(AttributeError, match="replace"):
        scene.run()

"""[unit.NAME] image: a case whose unit runs a program file, and mistakes in such a case."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.processor.image_files.assemble import assemble_file
from tests.interfaces.commands.conftest import Run, periph_sim  # noqa: F401

ECHO = Path(__file__).resolve().parents[2] / "firmware" / "c28x" / "sci_echo.asm"
CASE = """\
name = "echo"
duration = "6 ms"

[unit.dsp]
image = "echo.out"
modules = ["SCI-A", "GPIO"]

[serial]
baud = 115200

[[serial.send]]
name = "greeting"
to = "dsp.SCI-A"
text = "hi\\n"
at = "5 ms"

[[serial.expect]]
name = "echo"
from = "dsp.SCI-A"
text = "hi\\n"
after_send = "greeting"
within = "100 us"
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "echo.out").write_bytes(assemble_file(ECHO)[1])
    return tmp_path


def test_an_image_that_replies_within_its_budget_passes(periph_sim: Run, folder: Path):  # noqa: F811
    (folder / "echo.toml").write_text(CASE)
    came = periph_sim("run", str(folder / "echo.toml"))
    assert came.status == 0, came.out + came.err
    assert "3 SCI bytes" in came.out


def test_an_image_that_breaks_its_budget_fails(periph_sim: Run, folder: Path):  # noqa: F811
    (folder / "echo.toml").write_text(CASE.replace("100 us", "80 us"))
    assert periph_sim("run", str(folder / "echo.toml")).status == 1


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('image = "echo.out"\n', "", "a unit needs a program; give firmware, or image"),
        ("[serial]", 'firmware = "responder"\n[serial]', "a unit has one program; give firmware or image, not both"),
        ("[serial]", "pll = 5\n[serial]", "pll is of Python firmware; an image says that by itself, so leave it out"),
        ("[serial]", 'boot = "flash"\n[serial]', 'boot = "flash" begins at 0x33fff6, where this image has nothing'),
        (
            "[serial]",
            '[[unit.dsp.stub]]\nregister = "SYS.PLLSTS"\nvalue = 1\n[serial]',
            "SYS.PLLSTS is modelled; stubs are for registers that are not",
        ),
        (
            "[serial]",
            '[[unit.dsp.stub]]\nregister = "ADC.X"\nvalue = 1\n[serial]',
            "stub.0.register: there is no register",
        ),
        (
            'image = "echo.out"',
            'firmware = "responder"\nboot = "ram"',
            "boot is of an image; Python firmware begins at",
        ),
        ("echo.out", "none.out", "none.out: No such file or directory"),
        ("echo.out", "echo.toml", "it is neither TI COFF nor ELF"),
    ],
)
def test_bad_input_is_one_sentence_and_status_2(
    periph_sim: Run,  # noqa: F811
    folder: Path,
    old: str,
    new: str,
    sentence: str,
):
    (folder / "echo.toml").write_text(CASE.replace(old, new, 1))
    came = periph_sim("run", str(folder / "echo.toml"))
    assert (came.status, came.out) == (2, "")
    assert sentence in came.err and came.err.count("\n") == 1


WAITS = """ .sect ".text", 0x9000
 .global _c_int00, _convert
_c_int00: MOVW DP,#0x7029 >> 6
 EALLOW
 MOV @0x7029,#0x68
 EDIS
 LCR #_convert
 ESTOP0
_convert: MOVW DP,#0x7119 >> 6
wait: TBIT @0x7119,#2
 SB wait,NTC
 LRETR
"""
STUB = '[[unit.dsp.stub]]\nregister = "ADC.ADCST"\nvalue = 4\nafter = "1 ms"\n'


def test_a_wait_for_an_unmodelled_register_is_reported_and_a_stub_answers_it(periph_sim: Run, tmp_path: Path):  # noqa: F811
    (tmp_path / "adc.asm").write_text(WAITS)
    case = 'name = "adc"\nduration = "3 ms"\n[unit.dsp]\nimage = "adc.asm"\nmodules = []\n'
    (tmp_path / "adc.toml").write_text(case)
    stuck = " ".join(periph_sim("run", str(tmp_path / "adc.toml")).out.split())
    assert (
        "dsp waits for ADC.ADCST & 0x0004 at _convert (adc.asm:11, 0x00900c) since 3.467 us and would for ever: "
        'it is not modelled; answer it by [[unit.dsp.stub]] with register = "ADC.ADCST" and a value'
    ) in stuck
    (tmp_path / "adc.toml").write_text(case + STUB)
    answered = " ".join(periph_sim("run", str(tmp_path / "adc.toml")).out.split())
    assert "nothing models" not in answered and "ESTOP0 ended the program at 1002." in answered


LOST = """\
name = "lost"
duration = "1 ms"

[unit.dsp]
image = "lost.asm"
modules = ["GPIO"]

[[budget]]
name = "work"
measure = "time in _work"
max = "1 us"
"""


def test_a_program_whose_stack_overflows_has_verdicts_and_explanations(periph_sim: Run, tmp_path: Path):  # noqa: F811
    """The second run, for the explanation, ends at the same place."""
    (tmp_path / "lost.toml").write_text(LOST)
    source = ' .reserve ".stack", 0x400, 32\n .sect ".text", 0x9000\n .global _work\n_c_int00: MOV @SP,#0x400\n'
    (tmp_path / "lost.asm").write_text(f"{source} LCR #_work\n_work: LCR #_work\n")
    came = periph_sim("run", str(tmp_path / "lost.toml"), "--explain")
    assert (came.status, came.err) == (1, "")
    assert "work: " in came.out and "stuck: dsp: the stack grew beyond its section .stack" in came.out
    assert came.out.count("span _work begins") == 1

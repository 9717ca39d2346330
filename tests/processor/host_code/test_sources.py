"""[unit.NAME] sources: C firmware compiled for the host runs on the wires; programming errors end the run."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from periph_sim.core.input_files import inputs_of_one_command, is_input
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from periph_sim.scene.result import Result
from periph_sim.scene.scene import Scene
from tests.interfaces.commands.conftest import Run, periph_sim  # noqa: F401

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc, which compiles C sources, is not installed")

HERE = Path(__file__).parent
CASE = """\
name = "echo"
duration = "8 ms"

[unit.dsp]
sources = ["echo.c"]
modules = ["SCI-A", "GPIO"]
pins = { MARK = 31 }

[unit.dsp.compile]
include = ["."]

[serial]
baud = 115200

[[serial.send]]
name = "greeting"
to = "dsp.SCI-A"
text = "hi!"
at = "6 ms"

[[serial.expect]]
name = "echo"
from = "dsp.SCI-A"
text = "hi!"
after_send = "greeting"
within = "100 us"

[[budget]]
name = "marks"
measure = "count of edge MARK change"
exactly = 4  # down from its pull-up as it becomes an output, then one a character

[[budget]]
name = "load"
measure = "count of interrupt SCIRXINTA enter"
exactly = 3
"""
MAIN = '#include "device.h"\nint main(void) {{ {} }}\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for file in ("echo.c", "device.h"):
        shutil.copy(HERE / file, tmp_path)
    (tmp_path / "echo.toml").write_text(CASE)
    return tmp_path


def run(folder: Path, *changes: str) -> Result:
    return Scene(load(folder / "echo.toml", list(changes))).run()


SLOW_TO_BEGIN = """
import sys, time
from pathlib import Path
from periph_sim.processor.host_code import firmware
from periph_sim.processor.host_code.library import Library
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene

class SlowLibrary(Library):
    def __init__(self, *given):
        super().__init__(*given)
        since = time.process_time()
        while time.process_time() < since + 0.1:
            pass

firmware.Library = SlowLibrary
print(Scene(load(Path(sys.argv[1]))).run().verdict)
"""


BESIDE_A_BUSY_THREAD = """
import sys
from pathlib import Path
from threading import Thread
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene

def busy():
    while True:
        pass

Thread(target=busy, daemon=True).start()
print(*(Scene(load(Path(sys.argv[1]))).run().verdict for _ in range(3)))
"""


@pytest.mark.parametrize(("program", "said"), [(SLOW_TO_BEGIN, "pass\n"), (BESIDE_A_BUSY_THREAD, "pass pass pass\n")])
def test_the_timer_that_finds_empty_loops_disturbs_nothing_else(folder: Path, program: str, said: str):
    """It expires before the firmware's first call. It counts CPU time of all threads, and any may get its signal."""
    command = [sys.executable, "-c", program, str(folder / "echo.toml")]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=100)
    assert (done.returncode, done.stdout, done.stderr) == (0, said, "")


def test_no_output_replaces_a_header_wherever_it_is(folder: Path):
    below = folder / "my headers"
    below.mkdir()
    (below / "deeper.h").write_text("\n")
    (folder / "echo.c").write_text('#include "my headers/deeper.h"\n' + (folder / "echo.c").read_text())
    with inputs_of_one_command():
        load(folder / "echo.toml")
        assert is_input(folder / "device.h") and not is_input(below / "deeper.h")
        run(folder)
        assert is_input(below / "deeper.h")


def command(folder: Path, text: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run the case with this source in a process of its own."""
    (folder / "echo.c").write_text(text)
    given = [sys.executable, *(arguments or ("-m", "periph_sim")), "run", "echo.toml"]
    return subprocess.run(given, cwd=folder, capture_output=True, text=True, check=False)


def test_an_echo_by_interrupt_answers_on_the_line(folder: Path):
    result = run(folder)
    assert result.verdict == "pass", result
    assert result.estimated == ["dsp"]
    assert not [note for note in result.notes if "PLLCR" in note]


def test_macros_of_the_case_reach_the_sources(folder: Path):
    """Each answer is one more than the received character."""
    assert run(folder, "unit.dsp.compile.defines.FIRST=1").verdict == "fail"
    result = run(folder, "unit.dsp.compile.defines.FIRST=1", 'serial.expect.0.text="ij\\""')
    assert result.verdict == "pass", result


def test_two_runs_are_equal_because_each_initializes_its_variables(folder: Path):
    first, second = run(folder), run(folder)
    assert (first.events, first.budgets) == (second.events, second.budgets)


def test_the_verdict_states_that_times_are_estimated(periph_sim: Run, folder: Path):  # noqa: F811
    came = periph_sim("run", str(folder / "echo.toml"))
    assert came.status == 0
    assert came.out.startswith("echo: PASS, as seen in this run; cycles between accesses of dsp are estimated\n")
    assert "int has 32 bits, long and pointers 64, char 8 (on the chip 16, 32, 22, 16)" in came.out


def test_a_record_names_function_and_line(periph_sim: Run, folder: Path):  # noqa: F811
    line = 1 + (folder / "echo.c").read_text().splitlines().index("    SciaRegs.SCITXBUF = SciaRegs.SCIRXBUF + FIRST;")
    record = folder / "run.jsonl"
    assert periph_sim("run", str(folder / "echo.toml"), "--record", str(record)).status == 0
    written = [row for row in record.read_text().splitlines() if '"W SCI-A.SCITXBUF"' in row]
    assert len(written) == 3 and all(f'"character:{line}"' in row for row in written)


def test_time_passes_in_loops_without_any_access(folder: Path):
    """An empty loop, a counting loop and a delay of the headers pass time; then MARK changes."""
    body = (
        "long i; EALLOW; SysCtrlRegs.WDCR = 0x68; GpioCtrlRegs.GPADIR = 0x80000000; EDIS;"
        "for (i = 0; i < 1000; i++); DSP28x_usDelay(1000); GpioDataRegs.GPASET.all = 0x80000000; for (;;);"
    )
    (folder / "echo.c").write_text(MAIN.format(body))
    scene = Scene(load(folder / "echo.toml", ["serial={}", "budget.marks.exactly=2", "budget.load.exactly=0"]))
    assert scene.run().verdict == "pass"


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        (
            "*(int *)0 = 1;",
            "Segmentation fault at main:2, the host's address 0x0; access a register by its structure's name",
        ),
        ("volatile int zero = 0; return 7 / zero;", "Floating point exception at main:2"),
        ('asm(" ITRAP0");', "asm(' ITRAP0') is not known on the host"),
        ('asm(" ESTOP0");', "ESTOP0 is reached at main:2"),
        (
            "((volatile unsigned short *)&SciaRegs)[1] = 3;",
            "an access of 2 bytes at main:2 is not a register's, 2 bytes into word 0x7050; access a register by the "
            "member of its structure",
        ),
        ("void exit(int); exit(0);", "exit(0) is called at main:2; firmware on the chip cannot end"),
    ],
)
def test_errors_of_firmware_end_the_run_with_their_place(folder: Path, body: str, sentence: str):
    came = command(folder, MAIN.format(body))
    assert (came.returncode, came.stderr) == (1, "") and f"stuck: dsp: {sentence}" in came.stdout


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        ("void abort(void); abort();", "abort() is called at main:2; firmware on the chip cannot end"),
        ("\n#include <assert.h>\nassert(1 + 1 == 3);", "assert(1 + 1 == 3) fails at main:4"),
        (
            "int deeper(int i) { int big[4096]; return deeper(i) + 1; } deeper(0);",
            "the stack has more than 1 MB at deeper.0:2",
        ),
        ("struct SCI_REGS copy = SciaRegs;", "an access of 64 bytes at main:2 is not a register's"),
        ("*(volatile Uint32 *)&SciaRegs = 1;", "an access of 8 bytes at main:2 is not a register's"),
    ],
)
def test_misuse_of_replaced_functions_and_registers_ends_the_run_with_its_place(folder: Path, body: str, sentence: str):
    (folder / "echo.c").write_text(MAIN.format(body))
    assert f"dsp: {sentence}" in "".join(run(folder).stuck)


@pytest.mark.parametrize(
    ("change", "text", "sentence"),
    [
        ("", "int main(void) { retrun 0; }", "echo.c, line 1: gcc says: "),
        ("", '#include "none.h"\n', "echo.c, line 1: gcc says: none.h: No such file or directory; add it, or its"),
        ("", "void f(void); int main(void) { f(); }", "no source defines 'f'; add the file that does to sources"),
        ('unit.dsp.sources=["echo.c", "echo.c"]', "int main(void) { return 0; }", "echo.c define 'main'; leave one"),
        ('unit.dsp.sources=["none.c"]', "", "there is no source file"),
        ('unit.dsp.image="x.out"', "", "a unit has one program; give image or sources, not both"),
        ("unit.dsp.settings.x=1", "", "only Python firmware has settings; sources take [unit.NAME.compile] defines"),
    ],
)
def test_errors_of_gcc_and_of_the_case_give_one_sentence(folder: Path, change: str, text: str, sentence: str):
    if text:
        (folder / "echo.c").write_text(text)
    with pytest.raises(BadCase) as refused:
        run(folder, *([change] if change else []))
    assert sentence in str(refused.value) and "\n" not in str(refused.value)


def test_a_header_is_found_whatever_the_case_of_its_letters(folder: Path):
    text = (folder / "echo.c").read_text()
    (folder / "echo.c").write_text(text.replace("device.h", "DEVICE.H"))
    assert run(folder).verdict == "pass"


def test_ctrl_c_while_c_code_runs_ends_the_run(folder: Path):
    """The firmware sends the signal itself, so that it arrives between two calls of Python."""
    # A process started in the background has SIGINT ignored, and Python would keep that.
    begin = "import signal, runpy; signal.signal(signal.SIGINT, signal.default_int_handler); "
    text = "int raise(int);\n" + MAIN.format("raise(2); for (;;) SciaRegs.SCIRXST.all;")
    came = command(folder, text, "-c", begin + "runpy.run_module('periph_sim', run_name='__main__')")
    assert (came.returncode, came.stdout, came.stderr.strip()) == (2, "", "stopped")


def test_a_source_that_is_not_text_gives_one_sentence(folder: Path):
    (folder / "echo.c").write_bytes(bytes(range(128, 256)))
    with pytest.raises(BadCase, match=r"echo\.c, line 1: gcc says: "):
        run(folder)


def test_sources_without_main_are_refused(folder: Path):
    came = command(folder, "int f(void) { return 0; }\n")
    assert came.returncode == 2 and "dsp: no source has a function main" in came.stderr


def test_undefined_behaviour_is_reported_on_standard_error(folder: Path):
    (folder / "echo.toml").write_text(CASE.replace('["."]', '["."]\nundefined = true'))
    came = command(folder, MAIN.format("volatile int i = 0x7FFFFFFF; i = i + 1; for (;;);"))
    assert "echo.c:2:" in came.stderr and "signed integer overflow" in came.stderr


def test_two_units_with_the_same_sources_have_their_own_variables_and_registers(folder: Path):
    two = CASE.replace(
        "[serial]", '[unit.other]\nsources = ["echo.c"]\nmodules = ["SCI-B"]\ncompile = { include = ["."] }\n[serial]'
    )
    (folder / "echo.toml").write_text(two)
    assert run(folder).verdict == "pass"

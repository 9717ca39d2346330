"""`periph-sim new image` and `new c`: a run finds boot mode, modules, pins, vectors and loops; the case passes."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from periph_sim.interfaces.commands import program_case
from periph_sim.interfaces.commands.program_case import LoopCalls
from periph_sim.processor.image_files.program_file import program_in
from tests.interfaces.commands.conftest import Run

C28X = Path(__file__).parents[3] / "firmware" / "c28x"

CODESTART = """
          .sect "codestart", 0x33FFF6
          LB    _c_int00
"""
HEAD = """
          .include "f28335.inc"
          .reserve ".stack", 0x400, 0x300
          {codestart}
          .sect ".text", {text}
          .global _c_int00, _main, _once, _often
_c_int00: MOV   @SP,#0x400
          EALLOW
          MOVW  DP,#WDCR >> 6
          MOV   @WDCR,#{wdcr}
          EDIS
          LCR   #_main
          ESTOP0
"""
LOOP = """
_main:    LCR   #_often
          LCR   #_often
loop:     LCR   #_once
          LCR   #_often
          LCR   #_often
          SB    loop,UNC
_once:    NOP
          LRETR
_often:   MOVL  XAR4,#{passes}
wait:     BANZ  wait,AR4--
          LRETR
"""


def program(body: str, codestart: str = "", text: int = 0x9000, wdcr: int = 0x68) -> None:
    Path("mine.asm").write_text(HEAD.format(codestart=codestart, text=text, wdcr=wdcr) + body, encoding="utf-8")


def written() -> dict[str, Any]:
    return tomllib.loads(Path("mine.toml").read_text(encoding="utf-8"))


def test_interrupts_their_periods_and_pins_become_budgets_that_hold(periph_sim: Run, here: Path):
    source = (C28X / "blink.asm").read_text(encoding="utf-8")
    Path("mine.asm").write_text(source, encoding="utf-8")
    out = periph_sim.passes("new", "image", "mine.asm")
    assert "periph-sim run mine.toml\n" in out and "periph-sim worst mine.toml 'latency of TINT0'\n" in out
    text, case = Path("mine.toml").read_text(encoding="utf-8"), written()
    assert "# vector: TINT0, served by _toggle\n" in text
    assert "# clock: PLLCR = 10, DIVSEL = 2; SYSCLKOUT is 150 MHz if the crystal has oscclk\n" in text
    unit = case["unit"]["dsp"]
    assert unit["modules"] == ["GPIO", "TIMER0"] and unit["pins"] == {"GPIO31": 31} and unit["boot"] == "entry"
    assert {budget["measure"] for budget in case["budget"]} == {
        "interrupt latency TINT0",
        "period of interrupt TINT0 enter",
        "period of edge GPIO31 rise",
    }
    assert case["budget"][0]["max"] == "0.103 us"  # 0.0933 us and 10 %, rounded up
    assert {budget["why"] for budget in case["budget"]} == {"seen, not required"}
    assert periph_sim("run", "mine.toml").out.startswith("mine: PASS")
    assert periph_sim("worst", "mine.toml", "latency of TINT0").status == 0
    Path("mine.asm").write_text(source.replace("75000", "90000"), encoding="utf-8")
    assert "period of TINT0" in periph_sim("run", "mine.toml").out and periph_sim("run", "mine.toml").status == 1


def test_codestart_sets_the_boot_mode_and_a_function_called_once_names_the_loop(periph_sim: Run, here: Path):
    program(LOOP.format(passes=20_000), CODESTART, text=0x33_0000)
    assert periph_sim("new", "image", "mine.asm").status == 0
    case = written()
    assert case["unit"]["dsp"]["boot"] == "flash" and case["unit"]["dsp"]["modules"] == []
    assert [budget["measure"] for budget in case["budget"]] == ['period of span "_once" begin']
    assert periph_sim("run", "mine.toml").status == 0


def test_unusual_pins_and_pins_of_external_interrupts_are_written(periph_sim: Run, here: Path):
    """GPBMUX1 = 0x540: SCIRXDA is on GPIO36, SCITXDA on GPIO35. GPIOXINT1SEL = 13 and XINT1CR.ENABLE select XINT1."""
    program(
        "_main: EALLOW\n MOVW DP,#0x6F96 >> 6\n MOV @0x6F96,#0x0140\n MOVW DP,#0x6FE0 >> 6\n MOV @0x6FE0,#13\n EDIS\n"
        " MOVW DP,#0x7070 >> 6\n MOV @0x7070,#1\n MOVW DP,#0x7050 >> 6\n MOV @0x7050,#7\n"
        "loop: NOP\n SB loop,UNC\n_once:\n_often:\n"
    )
    assert periph_sim("new", "image", "mine.asm").status == 0
    unit = written()["unit"]["dsp"]
    assert unit["pins"] == {"RX": 36, "TX": 35, "XINT1": 13}
    assert unit["modules"] == ["SCI-A", "GPIO", "XINT"]


def test_an_image_without_symbols_is_a_note(periph_sim: Run, here: Path, monkeypatch: pytest.MonkeyPatch):
    program(LOOP.format(passes=100))
    monkeypatch.setattr(program_case, "program_in", lambda path: replace(program_in(path), symbols=()))
    result = periph_sim("new", "image", "mine.asm")
    note = "note: the image has no symbols, so no function has a name; link it with symbols, and compile it with -g\n"
    assert result.status == 0 and note in result.out


@pytest.mark.parametrize(("address", "boot"), [(0, "ram"), (0x9800, "entry")])
def test_a_codestart_at_another_address_sets_another_boot_mode(periph_sim: Run, here: Path, address: int, boot: str):
    program(LOOP.format(passes=100), CODESTART.replace("0x33FFF6", str(address)))
    assert periph_sim("new", "image", "mine.asm").status == 0
    assert written()["unit"]["dsp"]["boot"] == boot


def test_an_output_that_rises_once_is_named_and_has_no_period(periph_sim: Run, here: Path):
    program(
        "_main: EALLOW\n MOVW DP,#GPADIR >> 6\n OR @GPADIR,#1\n EDIS\n MOVW DP,#0x6FC2 >> 6\n"
        " MOV @0x6FC2,#1\n MOV @0x6FC2,#1\n MOV @0x6FC2,#1\nloop: NOP\n SB loop,UNC\n_once:\n_often:\n"
    )
    assert periph_sim("new", "image", "mine.asm").status == 0
    assert written()["unit"]["dsp"]["pins"] == {"GPIO0": 0} and "budget" not in written()


def test_the_run_lasts_until_something_has_repeated(periph_sim: Run, here: Path, monkeypatch: pytest.MonkeyPatch):
    """Skipped passes of delay loops do not count as work that ends the run."""
    monkeypatch.setattr(program_case, "MOST_WORK", 20_000)
    program(LOOP.format(passes=60_000))
    assert periph_sim("new", "image", "mine.asm").status == 0
    assert written()["duration"] == "500 ms" and len(written()["budget"]) == 1


@pytest.mark.parametrize(
    ("body", "wdcr", "notes"),
    [
        (
            "_main: LRETR\n_once:\n_often:\n",
            0x68,
            ["ESTOP0 ended the program at ", "nothing repeats, so the case has no budget"],
        ),
        (
            "_main: SB _main,UNC\n_once:\n_often:\n",
            0x28,
            [
                "its watchdog reset it 4 times, first at _main (mine.asm:14, ",
                "nothing repeats, so the case has no budget",
            ],
        ),
        (
            "_main: MOVW DP,#0x7119 >> 6\nlook: TBIT @0x7119,#0\n SB look,NTC\n LRETR\n_once:\n_often:\n",
            0x68,
            [
                "dsp waits for ADC.ADCST & 0x0001 at _main (mine.asm:16, ",
                "nothing repeats, so the case has no budget; add",
            ],
        ),
        (
            "_main: OR IER,#1\n MOVW DP,#PIEIER1 >> 6\n MOV @PIEIER1,#0x20\n MOV @0x0CE6,#1\n EALLOW\n CLRC INTM\n"
            "loop: NOP\n SB loop,UNC\n_once:\n_often:\n",
            0x68,
            [
                "a module without a model did not request ADCINT, served by ",
                "nothing repeats, so the case has no budget; add",
            ],
        ),
    ],
)
def test_a_program_without_a_repetition_gets_a_note_with_the_reason(
    periph_sim: Run, here: Path, body: str, wdcr: int, notes: list[str]
):
    program(body, wdcr=wdcr)
    result = periph_sim("new", "image", "mine.asm")
    assert result.status == 0 and "budget" not in written()
    report = [line.removeprefix("note: ") for line in result.out.splitlines() if line.startswith("note: ")]
    assert len(report) == len(notes) and all(line.startswith(note) for line, note in zip(report, notes, strict=True)), (
        report
    )
    assert "periph-sim worst" not in result.out and "limits:" not in Path("mine.toml").read_text(encoding="utf-8")
    assert report[-1].endswith("without a model") or report[-1] == notes[-1]


def test_a_program_that_cannot_run_has_no_case(periph_sim: Run, here: Path):
    program("_main: .word 0\n_once:\n_often:\n")
    message = "mine.asm: it cannot run, so no case was written: dsp: 0x0000 is the illegal"
    assert message in periph_sim.refused("new", "image", "mine.asm")
    assert not Path("mine.toml").exists()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["image"], "new image needs a .out, as in periph-sim new image firmware.out"),
        (["image", "none.out"], "none.out: No such file or directory; give the linker's .out file, or assembly (.asm)"),
        (["c"], "new c needs a folder, as in periph-sim new c firmware"),
        (["c", "none"], "none: there is no such folder; give the folder of the .c files"),
        (["c", "there.asm"], "there.asm: it is no folder; give the folder of the .c files"),
        (["image", "there.asm"], "there.toml: exists already; move it, or type the command in another folder"),
        (["c", "empty"], "empty: there is no C source below it; give the folder of the .c files"),
        (["c", "part"], "part: there is 1 C source below it, but none defines main; add the file that does"),
    ],
)
def test_a_wrong_program_is_one_error_message(periph_sim: Run, here: Path, arguments: list[str], sentence: str):
    Path("empty").mkdir()
    Path("there.asm").write_text((C28X / "blink.asm").read_text(encoding="utf-8"), encoding="utf-8")
    Path("there.toml").touch()
    Path("part").mkdir()
    Path("part/help.c").write_text("int help(void) { return domain(3); }\n", encoding="utf-8")
    assert periph_sim.refused("new", *arguments).endswith(sentence)


C = """
#include "chip.h"

int main(void)
{
    asm(" EALLOW");
    *(&GpioCtrlRegs.GPADIR) |= 1ul << 5;
    asm(" EDIS");
    for (;;) {
        GpioDataRegs.GPATOGGLE = 1ul << 5;
        DSP28x_usDelay(750);
    }
}
"""
CHIP = """
struct GPIO_CTRL_REGS { unsigned long GPACTRL, GPAQSEL1, GPAQSEL2, GPAMUX1, GPAMUX2, GPADIR; };
struct GPIO_DATA_REGS { unsigned long GPADAT, GPASET, GPACLEAR, GPATOGGLE; };
extern volatile struct GPIO_CTRL_REGS GpioCtrlRegs;
extern volatile struct GPIO_DATA_REGS GpioDataRegs;
extern void DSP28x_usDelay(unsigned long passes);
"""


def test_c_sources_and_headers_below_a_folder_are_found(periph_sim: Run, here: Path):
    for file, text in (("led/src/main.c", C), ("led/include/chip.h", CHIP), ("led/src/GlobalVariableDefs.c", "?")):
        Path(file).parent.mkdir(parents=True, exist_ok=True)
        Path(file).write_text(text, encoding="utf-8")
    periph_sim.passes("new", "c", "led")
    case = tomllib.loads(Path("led.toml").read_text(encoding="utf-8"))
    unit = case["unit"]["dsp"]
    assert (unit["sources"], unit["compile"]) == (["led/src/main.c"], {"include": ["led/include"]})
    assert (unit["modules"], unit["pins"]) == (["GPIO"], {"GPIO5": 5})
    assert [budget["name"] for budget in case["budget"]] == ["period of GPIO5"]
    assert periph_sim("run", "led.toml").status == 0


def test_an_interrupt_that_is_enabled_but_was_not_requested_is_named(periph_sim: Run, here: Path):
    result = periph_sim("new", "c", str(C28X.parent / "c"))
    assert "note: SCI-A did not request SCIRXINTA, which is enabled\n" in result.out


def test_the_current_folder_gives_the_case_its_name(periph_sim: Run, here: Path, monkeypatch: pytest.MonkeyPatch):
    Path("led").mkdir()
    monkeypatch.chdir("led")
    Path("main.c").write_text("int main(void) { for (;;); }\n", encoding="utf-8")
    result = periph_sim("new", "c", ".")
    assert result.out.startswith(
        "written: led.toml\nnote: its watchdog reset it 4 times, first at 4369.067 us; disable"
    )


def test_a_header_that_is_missing_is_named_with_the_file_that_includes_it(periph_sim: Run, here: Path):
    Path("led").mkdir()
    Path("led/main.c").write_text('#include "chip.h"\nint main(void) { for (;;); }\n', encoding="utf-8")
    Path("led/chip.h").write_text('\n#include "gone.h"\n', encoding="utf-8")
    why = "led/chip.h, line 2: gcc says: gone.h: No such file or directory; add it, or its folder to compile.include"
    assert periph_sim.refused("new", "c", "led") == f"no case was written: {why}"


def test_c_sources_that_do_not_compile_have_no_case(periph_sim: Run, here: Path):
    Path("bad/lib").mkdir(parents=True)
    Path("bad/main.c").write_text("int main(void) { for (;;); }\n", encoding="utf-8")
    Path("bad/lib/again.c").write_text("int main(void) { for (;;); }\n", encoding="utf-8")
    message = periph_sim.refused("new", "c", "bad")
    assert message.startswith("no case was written: ") and message.endswith("define 'main'; leave one of them out")
    assert not Path("bad.toml").exists()


def test_the_outermost_loop_is_the_one_that_still_calls_functions():
    calls = LoopCalls()
    calls.called("main", 0)
    for tick in range(10):
        calls.called("early", tick)
        calls.returned("early", tick)
    for tick in range(100, 200, 10):
        for name in ("twice", "twice", "isr", "once"):
            calls.called(name, tick)
            calls.returned(name, tick)
    assert calls.once_per_pass({"isr"}, 50) == "once"
    assert calls.once_per_pass({"isr", "once"}, 50) == "twice"
    assert calls.once_per_pass(set(), 300) == ""
    calls.called("rare", 200)
    assert calls.once_per_pass({"isr"}, 50) == ""

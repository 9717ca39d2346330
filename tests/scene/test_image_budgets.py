"""Budgets on functions, variables and the stack of an image, with a program in assembly."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim import BadCase, Scene, load
from periph_sim.core.records import Kind
from periph_sim.processor.image_files.assemble import assemble
from periph_sim.processor.image_files.coff2 import write
from periph_sim.records.cause_trace.why import text, why
from tests.interfaces.reports.explain.made import explain
from tests.records.scenes import recorded
from tests.scene import runs
from tests.scene.small import sentence_of

# Main calls _work three times. Each call waits 200 cycles, counts, and keeps 2 words on the stack beside its return
# address. After reset the clock is 7.5 MHz, so 200 cycles are 26.7 us.
SOURCE = """
WDCR .set 0x7029
 .sect ".text", 0x9000
 .sect ".ebss", 0x9800
 .global _c_int00, _main, _work, _count, _total, _step
_count: .word 0
_step: .word 1
_total: .long 0
 .reserve ".stack", 0x400, 0x40
 .sect ".boot", 0x9100
_c_int00: MOV @SP,#0x400
 EALLOW
 MOVW DP,#WDCR >> 6
 MOV @WDCR,#0x68
 EDIS
 LCR #_main
 ESTOP0
_main: MOVB XAR2,#2
again: LCR #_work
 BANZ again,AR2--
 LRETR
_work: PUSH XAR2
 RPT #199 || NOP
 MOVW DP,#_count >> 6
 MOV AL,@_step
 ADD @_count,AL
 MOVB ACC,#7
 SUBL @_total,ACC
 POP XAR2
 LRETR
"""


def seen(
    tmp_path: Path, budgets: dict[str, str], unit: str = "", *changes: str, source: str = SOURCE
) -> dict[str, float | int | None]:
    """Return the worst value of each budget; no limit matters."""
    (tmp_path / "own.out").write_bytes(write(assemble(source)))
    tables = "".join(
        f'[[budget]]\nname = "{name}"\nmeasure = "{measure}"\n{limit}\n'
        for name, text in budgets.items()
        for measure, limit in [text.split("; ")]
    )
    case = tmp_path / "own.toml"
    case.write_text(
        f'name = "own"\nduration = "1 ms"\n[unit.dsp]\nimage = "own.out"\nmodules = ["GPIO"]\n{unit}{tables}'
    )
    result = Scene(load(case, list(changes))).run()
    return {verdict.name: verdict.worst for verdict in result.budgets}


def test_functions_are_spans(tmp_path: Path):
    """_work: PUSH 1, RPT 1, 200 NOPs, 6 more instructions of one cycle, LRETR 4: 212 cycles of 7.5 MHz."""
    found = seen(
        tmp_path,
        {
            "calls": "calls of _work; exactly = 3",
            "each": 'each time in _work; max = "1 ms"',
            "sum": 'time in _work; max = "1 ms"',
            "from": 'from span _main begin to span _work begin; max = "1 ms"',
        },
    )
    work = 212 / 7.5
    assert found["calls"] == 3
    assert found["each"] == pytest.approx(work, abs=0.01)
    assert found["sum"] == pytest.approx(3 * work, abs=0.01)
    assert found["from"] == pytest.approx((1 + 4) / 7.5, abs=0.01)  # MOVB, LCR


def test_the_deepest_stack_in_words(tmp_path: Path):
    """Two calls save RPC, 2 words each, and PUSH saves XAR2: 2 + 2 + 2."""
    assert seen(tmp_path, {"stack": "stack high-water; max = 64"}) == {"stack": 6}


def test_variables_as_they_change(tmp_path: Path):
    found = seen(
        tmp_path,
        {
            "most": "level of variable _count; max = 9",
            "changes": "count of variable _count change; exactly = 3",
            "second": "count of variable _count = 2; exactly = 1",
            "held": 'each time in variable _count = 2; max = "1 ms"',
            "long": "level of variable _total-long; max = 0xFFFFFFFF",
        },
    )
    assert (found["most"], found["changes"], found["second"]) == (3, 3, 1)
    assert found["held"] == pytest.approx((212 + 4 + 4) / 7.5, abs=0.6)  # BANZ and LCR between
    assert found["long"] == 0x1_0000_0000 - 7


def test_a_case_sets_memory_by_symbol(tmp_path: Path):
    budgets = {"most": "level of variable _count; max = 99"}
    assert seen(tmp_path, budgets, "memory = { _step = 5 }\n") == {"most": 15}
    assert seen(tmp_path, budgets, "", "unit.dsp.memory._step=7") == {"most": 21}


def test_a_preset_that_main_begins_with_is_a_change_of_its_variable(tmp_path: Path):
    """The start-up code writes 1 to _step and 0 to _total, and MOVL writes both words of _total at once.

    _step  | 5 | 1 | 5 from main on
    _total | 0xFFFFFFFF | 0 | 0xFFFFFFFF from main on, then 7 less at each call of _work
    """
    start_up = "_c_int00: MOVW DP,#_step >> 6\n MOVB @_step,#1,UNC\n ZAPA\n MOVL @_total,ACC\n MOV @SP,#0x400"
    budgets = {
        "one": 'time in variable _step = 1; max = "1 ms"',
        "five": "count of variable _step = 5; exactly = 1",
        "all": "count of variable _step change; exactly = 2",
        "total": "count of variable _total-long change; exactly = 5",
    }
    memory = 'memory = { _step = 5, "_total-long" = 0xFFFFFFFF }\n'
    found = seen(tmp_path, budgets, memory, source=SOURCE.replace("_c_int00: MOV @SP,#0x400", start_up))
    assert found["one"] == pytest.approx((6 * 1 + 2 * 4 + 4) / 7.5, abs=0.01)  # EALLOW and EDIS take 4, LCR 4
    assert (found["five"], found["all"], found["total"]) == (1, 2, 5)


def test_a_cpu_in_idle_has_no_load(tmp_path: Path):
    """The CPU is busy for the 3 * 216 cycles and the code around them, of 7500; then IDLE, which nothing ends."""
    busy = seen(tmp_path, {"load": 'cpu load; max = "99 %"'})["load"]
    asleep = seen(tmp_path, {"load": 'cpu load; max = "99 %"'}, source=SOURCE.replace("ESTOP0", "IDLE"))["load"]
    assert busy == 100 and asleep == pytest.approx(100 * (3 * 216 + 24) / 7500, abs=0.2)


@pytest.mark.parametrize(
    ("budget", "unit", "sentence"),
    [
        ("level of variable _cuont; max = 1", "", "the image has no variable '_cuont'; did you mean _count?"),
        ("calls of _wrok; max = 1", "", "the image has no function '_wrok'; did you mean _work?"),
        ('each time in _wrok; max = "1 ms"', "", "the image has no function '_wrok'; did you mean _work?"),
        ('from span _wrok begin to span _work end; max = "1 ms"', "", "no function '_wrok'; did you mean _work?"),
        ('span:_wrok; max = "1 ms"', "", "the image has no function '_wrok'; did you mean _work?"),
        ("level of variable dsq:_count; max = 1", "", "there is no unit 'dsq'; did you mean dsp?"),
        ("calls of _work; max = 9", "memory = { _stpe = 1 }\n", "no variable '_stpe'; did you mean _step?"),
        ("calls of _work; max = 9", "memory = { _step = 65536 }\n", "_step has 16 bits, so 65536 does not fit"),
        ("calls of _work; max = 9", "memory = { _step = 1.5 }\n", "_step is not a float, so 1.5 does not fit"),
    ],
)
def test_names_and_values_that_an_image_does_not_have(tmp_path: Path, budget: str, unit: str, sentence: str):
    message = sentence_of(BadCase, lambda: seen(tmp_path, {"it": budget}, unit))
    assert sentence in message and "own.toml, line " in message


def test_calls_are_counted_also_of_a_function_that_is_never_called_or_given_by_its_address(tmp_path: Path):
    source = SOURCE + " .global _fails\n_fails: LRETR\n"
    assert seen(tmp_path, {"fails": "calls of _fails; max = 0"}, source=source) == {"fails": 0}
    assert seen(tmp_path, {"it": "calls of 0x380080; max = 9"}) == {"it": 0}


def test_an_endless_loop_is_recorded_as_a_wait_of_its_own(tmp_path: Path):
    (tmp_path / "own.asm").write_text(' .sect ".text", 0x9000\n .global _c_int00\n_c_int00: NOP\nloop: SB loop,UNC\n')
    (tmp_path / "own.toml").write_text('name = "own"\nduration = "1 ms"\n[unit.dsp]\nimage = "own.asm"\nmodules = []\n')
    scene, records = runs.recorded(load(tmp_path / "own.toml"), [Kind.WAIT])
    scene.run()
    assert [(record.what, record.value) for record in records] == [("endless loop", 1)]
    assert records[0].text == "_c_int00 (own.asm:4, 0x009001)"


def test_a_change_of_a_variable_is_recorded_with_its_instruction_and_explained_by_why(tmp_path: Path):
    (tmp_path / "own.asm").write_text(SOURCE)
    unit = 'image = "own.asm"\nmodules = ["GPIO"]'
    budget = 'name = "count"\nmeasure = "level of variable _count"\nmax = 3'
    (tmp_path / "own.toml").write_text(f'name = "own"\nduration = "1 ms"\n[unit.dsp]\n{unit}\n[[budget]]\n{budget}\n')
    run = recorded(load(tmp_path / "own.toml"))
    line = SOURCE.splitlines().index(" ADD @_count,AL") + 1
    change = run.record(run.rows(Kind.FLAG, "dsp.memory", "_count")[0])
    at = float(run.seconds(change.tick) * 10**6)
    assert change.value == 1 and change.text.startswith(f"_work (own.asm:{line}, 0x")
    found = text(why(run, f"_count@{at + 1:.3f}us"))
    assert found.startswith("dsp.memory._count at ") and ": 1 since " in found
    assert f"dsp.memory._count = 1 at _work (own.asm:{line}, " in " ".join(found.split())
    before = text(why(run, "memory._count@0.001ms"))
    assert "not known, it never changed" in before and "changed" in before.partition("forward:")[2]


def test_the_worst_depth_of_the_stack_and_the_last_call_are_explained_by_their_place(tmp_path: Path):
    """_work is the deepest function: LCR #_main and LCR #_work save 2 words each, PUSH XAR2 saves 2 more."""
    (tmp_path / "own.asm").write_text(SOURCE)
    budgets = 'budget = [{ name = "stack", measure = "stack high-water", max = 9 }, '
    budgets += '{ name = "calls", measure = "calls of _work", max = 9 }]\n'
    unit = '[unit.dsp]\nimage = "own.asm"\nmodules = ["GPIO"]\n'
    (tmp_path / "own.toml").write_text(f'name = "own"\nduration = "1 ms"\n{budgets}{unit}')
    case = load(tmp_path / "own.toml")
    explained = explain(case, Scene(case).run().budgets)
    push = SOURCE.splitlines().index("_work: PUSH XAR2") + 1
    found = {name: [(step.what, str(step.place)) for step in one.chain.steps] for name, one in explained.items()}
    assert found["stack"][0][0] == "CPU.stack = 6" and found["stack"][0][1].startswith(f"own.asm:{push} (_work, 0x")
    assert [what for what, _ in found["calls"]] == ["span _work begins"]
    assert found["calls"][0][1].startswith(f"own.asm:{push} (_work, 0x")


RACE = """
 .include "f28335.inc"
 .reserve ".stack", 0x400, 0x40
 .sect ".text", 0x9000
 .global _c_int00
_c_int00: MOV @SP,#0x400
 LCR #_start_chip
 MOVW DP,#TIMER0PRD >> 6
 MOVL XAR4,#999
 MOVL @TIMER0PRD,XAR4
 MOV @TIMER0TCR,#0x0020
pass: TBIT @TIMER0TCR,#15
 SB pass,NTC
 OR @TIMER0TCR,#0x8000
 SB pass,UNC
 .include "start.inc"
"""


def test_a_race_is_counted_in_the_clock_that_the_program_set_up(tmp_path: Path):
    """The first poll is soon after the timer's start, and TIF rises 1000 cycles of 150 MHz later, 50 of 7.5 MHz."""
    (tmp_path / "own.asm").write_text(RACE)
    unit = '[unit.dsp]\nimage = "own.asm"\nmodules = ["TIMER0"]\nppm = 40\n'
    budget = 'budget = [{ name = "race", measure = "race TIMER0.TCR.TIF", max = 1000 }]\n'
    (tmp_path / "own.toml").write_text(f'name = "own"\nduration = "5 ms"\n{budget}{unit}')
    (verdict,) = Scene(load(tmp_path / "own.toml")).run().budgets
    assert verdict.count > 50 and 990 <= verdict.worst <= 1000

"""Declared conditions on a register have the cycles, records and events of the equivalent function."""

from __future__ import annotations

import sys
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.f28335.cpu.code_costs import BARE
from periph_sim.processor.source_location import SourceLocation
from periph_sim.processor.user_code import FirmwareError, Misuse
from tests.processor.bench import Bench, unit

FORMS = ("function", "declared")
flag_changes = st.lists(
    st.tuples(st.integers(1, 400), st.integers(0, 7), st.sampled_from([-1, -1, -1, 0, 1])), max_size=14
)


def either(form: str) -> Callable[[object, object], object]:
    """Select the function or the declared condition; both are in one line of the firmware."""
    return lambda function, condition: function if form == "function" else condition


def firmware(bench: Bench, form: str, kind: str, lead: int, timeout: int | None, pass_cycles: int | None):
    flags, cpu, of = bench.flags, bench.cpu, either(form)
    s = status = flags.STATUS
    loop, more = {"pass_cycles": pass_cycles}, {"pass_cycles": pass_cycles, "timeout": timeout}

    def isr(name: str, cost: int) -> None:
        bench.note(f"{name} in")
        cpu.compute(cost)
        if name == "IRQ1":
            bench.waits.spin(of(lambda: status.A == 0, status.when(A=0)))
        bench.pie_regs.PIEACK.all = 1
        bench.note(f"{name} out")

    cpu.program.handle("SEQ1INT", lambda: isr("IRQ0", 7))
    cpu.program.handle("SEQ2INT", lambda: isr("IRQ1", 23))

    spin_either = bench.waits.spin_either

    def main() -> None:
        cpu.compute(lead)
        while True:
            if kind == "field":
                came = bench.waits.spin(of(lambda: status.A == 1, status.when(A=1)), **more)
            elif kind == "mask":
                came = bench.waits.spin(of(lambda: (status.all & 5) == 4, status.when(mask=5, value=4)), **more)
            elif kind == "register":
                came = bench.waits.spin(of(lambda: status.all == 3, status.when(all=3)), **more)
            elif kind == "counter":  # a read clears the count
                came = bench.waits.spin(of(lambda: flags.COUNT.N == 1, flags.COUNT.when(N=1)), **more)
            else:
                came = spin_either(*of((lambda: s.A == 1, lambda: s.B == 1), (s.when(A=1), s.when(B=1))), **loop)
            bench.note(f"came {came}")
            if timeout is None:
                bench.waits.spin(of(lambda: status.A == 0, status.when(A=0)), timeout=90)
            bench.note("gone")
            flags.STATUS.C = 1

    return main


def comparable(record: Record) -> tuple[object, ...]:
    """Return a record for comparison; a place in the firmware as file and line, since each lambda has its own name."""
    text = record.text
    place = (text.path, text.line) if isinstance(text, SourceLocation) else text
    return (record.tick, record.kind, record.where, record.what, record.value, record.cause, place)


def run_of(form, changes, kinds, *, loop=10, skip=True, interrupts=True, **given):
    recorder, found = Recorder(), []
    if kinds:
        recorder.subscribe(kinds, found.append)
    bench = Bench(list(changes), code=replace(BARE, poll_pass=loop), skip_polls=skip, recorder=recorder)
    if interrupts:
        bench.enable()
    log = bench.run(firmware(bench, form, **given), 900)
    return log, bench.kernel.events, bench.cpu.program.polls_skipped, [comparable(record) for record in found]


@settings(max_examples=150, deadline=None)
@given(
    changes=flag_changes,
    lead=st.integers(0, 40),
    kind=st.sampled_from(["field", "mask", "register", "counter", "either"]),
    loop=st.integers(3, 31),
    interrupts=st.booleans(),
    skip=st.booleans(),
    timeout=st.sampled_from([None, 1, 40, 333]),
    pass_cycles=st.sampled_from([None, 12, 40]),
    kinds=st.sampled_from([(), (Kind.WAIT, Kind.FLAG), (Kind.ACCESS, Kind.WAIT, Kind.IRQ, Kind.FLAG)]),
)
def test_a_declared_wait_equals_the_wait_for_its_function(changes, kinds, **given):
    function, declared = (run_of(form, changes, kinds, **given) for form in FORMS)
    assert declared == function
    assert not kinds or declared[3]


def test_no_pass_of_a_declared_wait_calls_the_firmware():
    calls = {}
    for form in FORMS:
        bench = Bench([(2000, 1, -1)], skip_polls=False)
        flags = bench.flags
        seen = either(form)(lambda: flags.STATUS.A == 1, flags.STATUS.when(A=1))  # noqa: B023
        made = calls[form] = []

        def count(frame, event, _, made=made) -> None:
            if event == "call" and frame.f_code.co_filename == __file__:
                made.append(frame.f_code.co_name)

        def main(waits=bench.waits, seen=seen, count=count) -> None:
            sys.setprofile(count)
            try:
                waits.spin(seen)
            finally:
                sys.setprofile(None)

        bench.run(main, 3000)
    assert len(calls["function"]) == 201 and calls["declared"] == []


def test_declared_conditions_on_halves_of_32_bit_registers_equal_functions():
    came: dict[str, list[int]] = {}
    for form in FORMS:
        dsp, kernel = unit("GPIO", "TIMER0")
        of, seen = either(form), came.setdefault(form, [])

        def main(dsp=dsp, of=of, seen=seen) -> None:
            gpio, timer = dsp.module("GPIO"), dsp.module("TIMER0")
            dsp.spin(of(lambda: gpio.GPADAT.GPIO28 == 1, gpio.GPADAT.when(GPIO28=1)))
            seen.append(dsp.cpu.cycle)
            timer.PRD.half.MSW = 0x12
            dsp.spin(of(lambda: timer.PRD.half.MSW == 0x12, timer.PRD.half.when(MSW=0x12)))
            dsp.spin(of(lambda: timer.PRD.all >> 16 == 0x12, timer.PRD.when(mask=0xFFFF_0000, value=0x12_0000)))
            seen.append(dsp.cpu.cycle)

        dsp.start(main)
        kernel.run_until(100_000)
    assert came["declared"] == came["function"] and len(came["declared"]) == 2


def test_calling_a_condition_makes_one_read():
    bench = Bench([(1, 1, -1)])
    answers: list[bool] = []

    def main() -> None:
        bench.cpu.compute(10)
        a, b = bench.flags.STATUS.when(A=1), bench.flags.STATUS.when(B=1)
        bench.note("declared")
        answers.extend((a(), b()))
        bench.note("read")

    assert bench.run(main, 100) == [("declared", 10), ("read", 16)]
    assert answers == [True, False]


NEEDS = "{}: FLAGS.STATUS.when needs one field and its number, when(NAME=1), or a mask= and a value="
WRONG = {
    "flags.STATUS.when(D=1)": "AttributeError at line {}: FLAGS.STATUS has no field 'D'; it has A, B, C",
    "flags.STATSU.when(A=1)": "AttributeError at line {}: FLAGS has no register 'STATSU'; did you mean STATUS?",
    "flags.STATUS.when(A=2)": "{}: FLAGS.STATUS.A == 2 never holds; expected a whole number from 0 to 0x1",
    "flags.STATUS.when(A='up')": "{}: FLAGS.STATUS.A == 'up' never holds; expected a whole number from 0 to 0x1",
    "flags.STATUS.when(mask=0, value=0)": (
        "{}: FLAGS.STATUS.when(mask=0, value=0) tests no bit; expected a mask of 1 to 0xffff"
    ),
    "flags.STATUS.when(mask=5, value=6)": (
        "{}: FLAGS.STATUS.when(mask=5, value=6) never holds: 0x2 is outside of the mask 0x5"
    ),
    "flags.STATUS.when(mask=1 << 16, value=0)": (
        "{}: FLAGS.STATUS.when(mask=65536, value=0): the mask does not fit; expected a whole number from 0 to 0xffff"
    ),
    "flags.STATUS.when(mask=1, value=-1)": (
        "{}: FLAGS.STATUS.when(mask=1, value=-1): the value does not fit; expected a whole number from 0 to 0xffff"
    ),
    "flags.STATUS.when(mask=1)": NEEDS,
    "flags.STATUS.when()": NEEDS,
    "flags.STATUS.when(A=1, B=0, C=1)": NEEDS,
    "flags.STATUS.when(A=1, D=1)": NEEDS,
    "flags.STATUS.when(A=1, B=2)": NEEDS,
    "flags.STATUS.when(A=1, mask=1, value=1)": NEEDS,
    "bool(flags.STATUS.when(A=1))": (
        "{}: a condition on FLAGS.STATUS.A has no value by itself; give it to dsp.spin, or call it"
    ),
}


@pytest.mark.parametrize("statement", WRONG)
def test_an_invalid_condition_is_refused_with_the_line_of_its_statement(statement: str):
    bench = Bench([])
    code = compile(f"def main():\n    {statement}\n", "blink.py", "exec")
    space: dict[str, object] = {"flags": bench.flags}
    exec(code, space)
    bench.cpu.start(space["main"])  # type: ignore[arg-type]
    with pytest.raises(FirmwareError) as raised:
        bench.kernel.run_until(1000)
    where = "2 of blink.py" if "line {}" in WRONG[statement] else "line 2 of blink.py"
    before = "dsp: " if "line {}" in WRONG[statement] else "dsp, "
    assert str(raised.value) == before + WRONG[statement].format(where)


def test_an_invalid_condition_on_a_half_is_refused():
    dsp, _ = unit("TIMER0")
    half = dsp.module("TIMER0").PRD.half
    with pytest.raises(AttributeError, match=r"TIMER0\.PRD\.half has no field 'all'"):
        half.when(mask=1, value=1)
    with pytest.raises(Misuse, match=r"TIMER0\.PRD\.half\.MSW == 65536 never holds"):
        half.when(MSW=1 << 16)

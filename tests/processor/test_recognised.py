"""A function that asks one field beside a number is made without Python from its second wait on; nobody can tell."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.core.records import EVERYWHERE, NOWHERE, OF_MODIFIES, Kind, Recorder, RecordSink
from periph_sim.processor.python.waits import Recogniser
from tests.processor.bench import Bench


@pytest.fixture(autouse=True)
def untraced(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where lines are counted or a debugger steps, each pass is called, so that it can be seen."""
    monkeypatch.setattr(sys, "gettrace", lambda: None)


flag_changes = st.lists(
    st.tuples(st.integers(1, 800), st.integers(0, 7), st.sampled_from([-1, -1, -1, 0])), min_size=1, max_size=20
)


class Kept(RecordSink):
    """Keeps all records; wants the places of these accesses only."""

    def __init__(self, places: int) -> None:
        self.found: list[object] = []
        self._topics: list[object] = []
        self._places = places

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        self._topics.append((kind, where, what))
        return len(self._topics) - 1

    def places(self, tag: int) -> int:
        return self._places

    def keep(self, tag: int, number: int, tick: int, value: int, text: str, cause: int, field: str) -> None:
        self.found.append((tick, self._topics[tag], number, value, cause, str(text), field))


def run_of(changes, lead, form, interrupts, timeout, kinds, places=None):
    """form: what a condition is wrapped in; what is no plain function is not recognised.

    places: which of them a keeper of the records wants; None where they are told whole.
    """
    recorder, found = Recorder(), []
    if kinds and places is None:
        recorder.subscribe(kinds, lambda r: found.append((r.tick, r.kind, r.what, r.value, r.cause, str(r.text))))
    elif kinds:
        kept = Kept(places)
        found = kept.found
        recorder.subscribe(kinds, kept)
    bench = Bench(list(changes), recorder=recorder)
    flags, cpu = bench.flags, bench.cpu

    def isr() -> None:
        cpu.compute(9)
        bench.waits.spin(form(lambda: flags.STATUS.A != 1), timeout=30)
        bench.pie_regs.PIEACK.all = 1
        bench.note("served")

    cpu.program.handle("SEQ1INT", isr)
    if interrupts:
        bench.enable()

    def main() -> None:
        cpu.compute(lead)
        while True:
            bench.waits.spin(form(lambda: flags.STATUS.A == 1), timeout=timeout)
            bench.note("A")
            bench.waits.spin_either(form(lambda: flags.STATUS.B > 0), form(lambda: flags.STATUS.A < 1))
            bench.note("B")
            bench.waits.spin(form(lambda: flags.STATUS.all == 4), timeout=timeout)
            flags.STATUS.C = 1

    log = bench.run(main, 1200)
    return log, bench.kernel.events, cpu.program.polls_skipped, found


@settings(max_examples=120, deadline=None)
@given(
    changes=flag_changes,
    lead=st.integers(0, 40),
    interrupts=st.booleans(),
    timeout=st.sampled_from([21, 40, 100]),
    kinds=st.sampled_from([(), (Kind.WAIT, Kind.FLAG), (Kind.ACCESS, Kind.WAIT, Kind.IRQ), (Kind.ACCESS,)]),
    places=st.sampled_from([None, NOWHERE, OF_MODIFIES]),
)
def test_recognised_or_called_in_each_pass_it_comes_out_the_same(changes, lead, interrupts, timeout, kinds, places):
    runs = [run_of(changes, lead, form, interrupts, timeout, kinds, places) for form in (lambda f: f, partial)]
    recognised, called = runs
    assert recognised == called


def second_wait(function, bench: Bench):
    """What is made of a function that was seen once, its register named once."""
    recogniser = Recogniser(bench.cpu.program)
    assert recogniser.condition(function) is None
    bench.flags.STATUS, bench.flags.COUNT  # noqa: B018
    return recogniser.condition(function)


def test_what_is_recognised():
    bench = Bench([])
    flags = bench.flags
    for function in (
        lambda: flags.STATUS.A == 1,
        lambda: flags.STATUS.A != 0,
        lambda: flags.STATUS.B < 1,
        lambda: flags.STATUS.B > 0,
        lambda: flags.STATUS.all == 7,
    ):
        assert second_wait(function, bench) is not None


def test_what_is_not():
    bench = Bench([])
    flags, other, seen = bench.flags, SimpleNamespace(STATUS=bench.flags.STATUS), []
    for function in (
        lambda: flags.STATUS.A,
        lambda: flags.STATUS.A == 1 or flags.STATUS.B == 1,
        lambda: 1 == flags.STATUS.A,  # noqa: SIM300
        lambda: flags.STATUS.A >= 1,
        lambda: flags.STATUS.A == True,  # noqa: E712
        lambda: flags.STATUS.A == 2,  # never holds: Python may say so
        lambda: flags.STATUS.nothing == 1,
        lambda: flags.COUNT.N == 1,  # its read clears it
        lambda: other.STATUS.A == 1,
        lambda: (seen.append(1), flags.STATUS.A == 1)[1],
        lambda level=1: level == flags.STATUS.A,
        bench.flags.STATUS.when(A=1),
    ):
        assert second_wait(function, bench) is None


@pytest.mark.parametrize(
    ("places", "fields", "whole"), [(NOWHERE, True, True), (OF_MODIFIES, True, False), (None, False, False)]
)
def test_a_program_with_places_of_its_own_reads_without_python_where_nobody_wants_them(places, fields, whole):
    recorder = Recorder()
    recorder.subscribe([Kind.ACCESS], (lambda record: None) if places is None else Kept(places))
    bench = Bench([], recorder=recorder)
    flags = bench.flags
    told_whole = places is None  # who is told a Record may look about, where a pass is made by Python
    assert (second_wait(lambda: flags.STATUS.A == 1, bench) is None) is told_whole
    assert (second_wait(lambda: flags.STATUS.all == 1, bench) is None) is told_whole
    bench.cpu.program.placed = lambda: None
    assert (second_wait(lambda: flags.STATUS.A == 1, bench) is not None) is fields
    assert (second_wait(lambda: flags.STATUS.all == 1, bench) is not None) is whole


def test_a_read_has_its_line_in_the_firmware_though_no_frame_is_there():
    recorder, kept = Recorder(), Kept(EVERYWHERE)
    recorder.subscribe([Kind.ACCESS], kept)
    bench = Bench([(400, 1, -1)], recorder=recorder)

    def polls():
        for _ in range(3):
            bench.waits.spin(
                lambda: (
                    flags.STATUS.A  # here
                    == 1
                ),
                timeout=30,
            )

    flags = bench.flags
    bench.run(polls, 600)
    lines = Path(__file__).read_text("utf-8").splitlines()
    line = next(n for n, text in enumerate(lines, 1) if text.endswith("STATUS.A  # here"))
    found = [text for *_, text, _ in kept.found]
    assert len(found) == 3 and set(found) == {f"<lambda>:{line}"}


def test_the_module_is_the_one_that_the_function_names_now():
    one, two = Bench([]), Bench([])
    recogniser, found = Recogniser(one.cpu.program), []

    def asks(flags):
        return lambda: flags.STATUS.A == 1

    for bench in (one, two, two, one):
        bench.flags.STATUS  # noqa: B018
        found.append(recogniser.condition(asks(bench.flags)))
    assert found[0] is None and found[1] is found[2] is not None and found[3] is not found[1]


def test_a_variable_without_a_value_is_left_to_python():
    recogniser = Recogniser(Bench([]).cpu.program)

    def asks():
        function = lambda: flags.STATUS.A == 1  # noqa: E731
        assert recogniser.condition(function) is None
        assert recogniser.condition(function) is None
        with pytest.raises(NameError):
            function()
        flags = Bench([]).flags
        return flags

    asks()

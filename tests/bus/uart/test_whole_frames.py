"""Frames in two events: who listens hears every edge at its tick, whoever looks; and what goes edge by edge."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.bus.uart.frame_format import UartFormat
from periph_sim.bus.uart.reader import Heard, UartReader
from periph_sim.bus.uart.sender import UartSender
from periph_sim.bus.uart.whole_frames import FrameParty, WholeFrames
from periph_sim.core.kernel import PROBE, Agent, Kernel
from periph_sim.core.records import Kind, Recorder
from periph_sim.core.wire import Wire, watch

BIT = Fraction(1000)
FRAME = 10_000


class Ear(FrameParty):
    """Writes down what it hears, and until when it had not heard of a frame."""

    def __init__(self, wire: Wire, whole: bool = True) -> None:
        self.heard: list[tuple[int, int]] = []
        self.whole = whole
        self.untold_of: list[bool] = []
        watch([wire], self)

    def sampled(self, now: int, levels: int) -> None:
        self.heard.append((now, levels))

    def hears_whole(self, first: int, second: int, last: int) -> bool:
        assert first < second <= last
        return self.whole

    def untold(self, frames: WholeFrames | None) -> None:
        self.untold_of.append(frames is not None)


class Pulls(Agent):
    """Looks at who pulls the line, and at nothing else."""

    def pulled(self, line: int, now: int, pulling: int) -> None:
        """It need not know."""


class Line:
    """A sender on a wire whose frames may pass, and one who listens."""

    def __init__(self, passes: bool = True, recorded: bool = False) -> None:
        recorder = Recorder()
        if recorded:
            recorder.subscribe([Kind.EDGE], lambda record: None)
        self.kernel = Kernel()
        self.wire = Wire(self.kernel, "RX", recorder)
        self.ear = Ear(self.wire)
        self.sender = UartSender(self.kernel, recorder, self.wire, BIT)
        self.over: list[int] = []
        self.frames = WholeFrames(self.kernel, self.wire, ["host", "dsp"], {})
        if passes:
            self.sender.whole_frames = self.frames

    def send(self, data: bytes, *looks: tuple[int, Callable[[], None]]) -> list[tuple[int, int]]:
        for tick, look in looks:
            self.kernel.at(tick, look, PROBE)
        self.sender.send(data, Fraction(0), self.over.append)
        self.kernel.run_until(FRAME * (len(data) + 1))
        return self.ear.heard


def by_edges(data: bytes) -> list[tuple[int, int]]:
    return Line(passes=False).send(data)


def test_a_frame_is_two_events_and_every_edge_is_heard_at_its_tick():
    line = Line()
    assert line.send(b"U") == by_edges(b"U") and len(line.ear.heard) == 10
    assert (line.kernel.events, line.frames.frames, line.frames.passed) == (2, 1, 1)
    assert line.over == [FRAME] and line.ear.untold_of == [True, False]


@given(st.binary(min_size=1, max_size=4), st.lists(st.integers(1, 4 * FRAME), max_size=4, unique=True))
def test_who_looks_at_the_line_sees_it_as_it_is_and_the_rest_goes_by_edges(data: bytes, ticks: list[int]):
    levels: dict[bool, list[int]] = {}
    for passes in (False, True):
        line, seen = Line(passes), []

        def look(line: Line = line, seen: list[int] = seen) -> None:
            line.kernel.catch_up()
            seen.append(line.wire.level)

        assert line.send(data, *((tick, look) for tick in ticks)) == by_edges(data)
        assert line.over == [FRAME * len(data)]
        levels[passes] = seen
    assert levels[True] == levels[False]


@given(st.binary(min_size=1, max_size=3), st.lists(st.integers(1, 3 * FRAME), min_size=1, max_size=4, unique=True))
def test_who_looks_at_a_listener_finds_it_told_up_to_now_and_the_frame_goes_on(data: bytes, ticks: list[int]):
    line, known = Line(), by_edges(data)

    def look() -> None:
        line.frames.settle()
        assert line.ear.heard == [edge for edge in known if edge[0] <= line.kernel.now]

    assert line.send(data, *((tick, look) for tick in ticks)) == known
    assert line.frames.passed == line.frames.frames == len(data)


def test_a_frame_goes_by_edges_where_somebody_could_tell():
    def listener(line: Line) -> None:
        line.wire.watch(lambda tick, level: None)

    def stranger(line: Line) -> None:
        line.wire.attach("fault 0 (spike)")

    def puller(line: Line) -> None:
        line.wire.attach("dsp.GPIO28").drive(0)
        line.kernel.settle()

    def watcher(line: Line) -> None:
        line.wire.watch_pulls(Pulls())

    def not_whole(line: Line) -> None:
        line.ear.whole = False

    for spoil in (listener, stranger, puller, watcher, not_whole):
        line = Line()
        spoil(line)
        line.send(b"UU")
        assert (line.frames.frames, line.frames.passed) == (2, 0), spoil.__name__
    line = Line(recorded=True)
    assert line.send(b"UU") == by_edges(b"UU")
    assert (line.frames.frames, line.frames.passed) == (2, 0)


def test_a_units_pin_that_rests_keeps_nothing_from_passing_and_one_who_comes_in_the_middle_hears_edges():
    line = Line()
    line.wire.attach("dsp.GPIO28")
    came: list[Ear] = []
    line.send(b"UU", (3_500, lambda: came.append(Ear(line.wire))))
    assert (line.frames.frames, line.frames.passed) == (2, 1)
    assert came[0].heard == [edge for edge in by_edges(b"UU") if edge[0] > 3_500]


@pytest.mark.parametrize(("bit", "passed"), [(BIT, 3), (BIT * Fraction(102, 100), 3), (BIT / 2, 0)])
def test_a_reader_hears_the_same_frames_and_refuses_those_of_another_rate(bit: Fraction, passed: int):
    heard: dict[bool, list[Heard]] = {}
    for passes in (False, True):
        line = Line(passes)
        reader = UartReader(line.kernel, line.wire, lambda: (bit, UartFormat()))
        heard[passes] = []
        reader.on_end.append(heard[passes].append)
        line.send(b"aU\x00")
        if passes:
            assert line.frames.passed == passed
    assert heard[True] == heard[False] and len(heard[True]) >= 3

"""Words in the receive FIFO and when the receiver is ready: against arrivals one by one, and against runs."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from periph_sim.explain.bound.fifo_bound import Receiver, fifo_bounds
from periph_sim.explain.bound.form_of_case import closed_form
from periph_sim.explain.bound.terms import Bound, Term
from tests.explain.bound.cases import imu_hil
from tests.explain.bound.test_terms import SOURCE
from tests.scene.runs import run_case


def waiting(character: int, level: int, reads: list[int], end: int) -> int:
    """Most words that wait where they come back to back, the one that asks for service at 0; one read at each tick."""
    most = words = level
    for tick in range(1, end + 1):
        words += tick % character == 0
        most = max(most, words)
        words -= min(words, reads.count(tick))
    return most


@given(
    st.integers(1, 16),
    st.lists(st.integers(1, 300), min_size=1, max_size=12).map(sorted),
    st.integers(1, 120),
    st.integers(0, 50),
)
def test_high_water_is_what_words_back_to_back_make_of_it_and_no_less(level, reads, character, rest):
    """
    words   L     L+1    L+2          one of `character` ticks after the other
    routine |latency|  read read read ...
    """
    receiver = Receiver(level, tuple(reads), character, 0, False)
    routine = reads[-1] + rest
    if not receiver.keeps_up(0, routine):
        return
    assert level + receiver.more(0, routine) == waiting(character, level, reads, routine)


def test_a_receiver_is_empty_behind_the_frames_unless_it_is_said_not_to_be():
    """One word asks for service, and one read takes it: kept up with an empty FIFO, not with a word left in it."""
    empty = Receiver(1, (10,), 100, 0, False)
    assert empty.keeps_up(0, 20) and not replace(empty, left=1).keeps_up(0, 20)


def held_up(folder: Path, cycles: int) -> str:
    """The emulator whose service routine computes so long before it reads the first word, as a change of a case."""
    text = SOURCE.read_text(encoding="utf-8")
    before = "        self.frame = bytes(sci.SCIRXBUF"
    assert text.count(before) == 1
    name = folder / "held_up.py"
    name.write_text(text.replace(before, f"        self.dsp.compute({cycles})\n{before}"), encoding="utf-8")
    return f"unit.dsp.firmware={name}"


def fifo(*changes: str) -> dict[str, Bound]:
    return {bound.name: bound for bound in closed_form(imu_hil(*changes)).fifo}


def words(bound: Bound) -> tuple[int, ...]:
    return tuple(term.ticks for term in bound.terms)


@pytest.mark.parametrize(
    ("level", "cycles", "expected"),
    [(12, 10, (12, 0)), (4, 15_000, (4, 1)), (8, 27_000, (8, 2))],  # 100 us, 180 us; a character takes 87 us
)
def test_a_bound_of_the_fifo_is_reached(tmp_path, level: int, cycles: int, expected: tuple[int, int]):
    changes = (held_up(tmp_path, cycles), f"unit.dsp.settings.fifo_level={level}", "controller.first=50 ms")
    found = fifo(*changes)
    assert words(found["FIFO high-water"]) == expected and not found["overruns"].unproven
    ran = {verdict.name: verdict.worst for verdict in run_case(imu_hil(*changes), "0.006").result.budgets}
    assert ran["SCI FIFO high-water"] == sum(expected) and ran["SCI overruns"] == 0


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        (("unit.dsp.settings.fifo_level=13",), "the FIFO asks at 13 words, 12 words are read each time"),
        (("unit.dsp.settings.fifo_level=1", "unit.dsp.settings.frame_cost=90 us"), "the FIFO asks at 1 words"),
        (("unit.dsp.options.sci.oe_in_fifo_mode=per_unread_word",), "each word that finds another unread"),
        (("host.first=0 us",), "part of the first host frame, at 0.000 us, may come before"),
    ],
)
def test_why_overruns_are_not_bounded(changes: tuple[str, ...], reason: str):
    assert reason in fifo(*changes)["overruns"].unproven


@pytest.mark.parametrize("line", ["pie.PIEACK.all = 0x100", "sci.SCIFFRX.RXFFINTCLR = 1"])
def test_a_routine_that_is_not_entered_again_leaves_no_bound(tmp_path: Path, line: str):
    """
    words    12 | routine | 0 ... 12, and nobody asks
    """
    text = SOURCE.read_text(encoding="utf-8")
    assert text.count(f"        {line}") == 1
    name = tmp_path / "once.py"
    name.write_text(text.replace(f"        {line}", "        pass"), encoding="utf-8")
    assert "12 are left unread behind the frames" in fifo(f"unit.dsp.firmware={name}")["overruns"].unproven


def test_words_that_fill_the_fifo_are_none_too_many():
    receiver = Receiver(14, (*range(200, 320, 10), 330, 340), 100, 0, False)
    latency = (Term("latency", 0, ""),)
    high, lost = fifo_bounds(receiver, latency, 350)
    assert high.ticks == 16 and not lost.unproven
    high, lost = fifo_bounds(replace(receiver, delay=100), latency, 350)
    assert high.ticks == 17 and "17 words" in lost.unproven


SLOW_START = "unit.dsp.code.between_accesses=15"


def test_a_frame_that_comes_before_the_receiver_is_up_leaves_no_bound_of_age():
    """Part of the first frame is lost, each later one is read out of step, and no read has a frame's values."""
    early, late = (closed_form(imu_hil(SLOW_START, f"host.first={first} us")).ages[0] for first in (0, 60))
    assert early.unproven.startswith(
        "part of the first host frame, at 0.000 us, may come before the firmware receives at 3.313"
    )
    assert not late.unproven and late.ticks <= early.ticks


def test_a_wait_of_the_start_up_does_not_end_it(tmp_path: Path):
    """
    main   waits for BB = 0 | computes 100 us | sets up pins, SCI, interrupts
    host           | first frame, of which the receiver misses part
    """
    text = SOURCE.read_text(encoding="utf-8")
    before = "        start_pin(dsp, settings.pin)\n"
    assert text.count(before) == 1
    name = tmp_path / "slow.py"
    wait = "        dsp.spin(lambda: self.i2c.I2CSTR.BB == 0)\n        dsp.compute(15_000)\n"
    name.write_text(text.replace(before, wait + before), encoding="utf-8")
    form = closed_form(imu_hil(f"unit.dsp.firmware={name}", "host.first=60 us"))
    assert form.ages[0].unproven.startswith("part of the first host frame, at 60.000 us, may come before the firmware")
    assert not any("runs with interrupts masked" in bound.unproven for bound in form.fifo)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ("host.gap=200", "a frame of the host may be due while the one before is still sent"),
        ("unit.dsp.settings.fifo_level=8", "8 words, which do not make up a frame of 12"),
        (
            "unit.dsp.settings.fifo_level=4",
            "at 4 words, but 12 words are read each time",
        ),
    ],
)
def test_frames_that_are_left_out_or_served_in_parts_leave_no_bound_of_age(change: str, reason: str):
    assert reason in closed_form(imu_hil(change)).ages[0].unproven


def test_a_service_routine_that_takes_longer_the_second_time_counts_with_that_and_is_no_bound(tmp_path: Path):
    text = SOURCE.read_text(encoding="utf-8")
    last = "        sci.SCIFFRX.RXFFOVRCLR = 1\n"
    assert text.count(last) == 1
    longer = "        self.n = getattr(self, 'n', 0) + 1\n        self.dsp.compute(100 * self.n)\n"
    (tmp_path / "longer.py").write_text(text.replace(last, longer + last), encoding="utf-8")
    (_, plain), (_, routine) = (
        closed_form(imu_hil(*of)).handlers.terms for of in ((), (f"unit.dsp.firmware={tmp_path / 'longer.py'}",))
    )
    assert routine.ticks - plain.ticks == 200 * 20  # cycles: of two frames the second
    assert routine.unproven.split("; ")[0] == "SCIRXINTA took 154 cycles once and 254 another time"
    assert routine.unproven.count("another time") == 1


def test_a_parity_bit_makes_a_character_longer(tmp_path: Path):
    """Start, 8 bits and a parity bit are sampled; a stop bit may be cut short."""
    text = SOURCE.read_text(encoding="utf-8")
    call = "sci_fifo_receiver(dsp, settings.brr, settings.fifo_level"
    assert text.count(call) == 1
    (tmp_path / "parity.py").write_text(text.replace(call, f"{call}, 0x67"), encoding="utf-8")  # even parity
    receivers = (
        closed_form(imu_hil(*of)).handlers.receiver for of in ((), (f"unit.dsp.firmware={tmp_path / 'parity.py'}",))
    )
    plain, with_parity = (receiver.character for receiver in receivers if receiver is not None)
    assert with_parity * 9 == plain * 10

"""Races: distances between reads and changes, reconstructed polls, and flags lost by read-modify-writes."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from periph_sim.core.records import Kind
from periph_sim.firmware import start_i2c, start_pie
from periph_sim.processor.dsp import Dsp
from periph_sim.records.races import NearMiss, races
from periph_sim.records.races_text_report import as_json, text
from periph_sim.records.run import NotInRun, Run
from periph_sim.scene import unit as unit_module
from periph_sim.scene.firmware_loader import Firmware
from tests.records.scenes import ADDRESS, CYCLE, asks, by_hand, flag, line_of, ran, read, recorded, write
from tests.scene.small import case

STR = "I2C-A.I2CSTR"
RRDY, SCD = 0x0008, 0x0020


def test_the_closest_reads_before_and_after_a_change_and_the_decades():
    found = races(by_hand(read(100), flag(107, "RRDY", 1), read(150, place="g:2"), read(5000, place="g:2")))
    f, g = found.places
    assert (f.place, f.reads, f.before and f.before.cycles, f.after) == ("f:1", 1, 7, None)
    assert (g.place, g.reads, g.before, g.after and g.after.cycles) == ("g:2", 2, None, 43)
    assert (f.histogram, g.histogram) == ((0, 1, 0, 0, 0, 0), (0, 0, 1, 0, 1, 0))
    assert found.closest == 7 and f.before.field == g.after.field == "RRDY"


def test_a_distance_is_counted_in_cycles_of_the_clock_at_that_time():
    """SYSCLKOUT doubles when the register is read. Ten cycles after that take the time of five before."""
    run = by_hand(flag(90, "RRDY", 1), read(100), flag(110, "RRDY", 0))
    clocks = {"dsp": [(0, Fraction(75_000_000)), (100 * CYCLE, Fraction(150_000_000))]}
    (place,) = races(Run(replace(run.table, clocks=clocks))).places
    assert (place.after and place.after.cycles, place.before and place.before.cycles) == (5, 10)


def test_a_read_without_any_change_has_no_distance():
    (place,) = races(by_hand(read(100))).places
    assert (place.reads, place.closest, place.alone) == (1, None, 1)


def test_a_read_in_the_cycle_of_a_change_is_before_or_after_it_by_record_order():
    found = races(by_hand(read(100), flag(100, "RRDY", 1), read(300, place="g:2")))
    (f, _) = found.places
    assert (f.before and f.before.cycles, f.histogram[0]) == (0, 1)


def test_changes_by_the_firmware_itself_are_not_races():
    found = races(by_hand(read(100), write(102, SCD), flag(102, "SCD", 0, cause=2), read(105)))
    assert found.closest is None and found.places[0].alone == 2


def test_races_of_one_field_of_a_register():
    run = by_hand(read(100), flag(103, "BB", 1), flag(150, "RRDY", 1))
    closest = {name: races(run, name).closest for name in (STR, f"{STR}.RRDY", "dsp.I2CA.I2CSTR.bb")}
    assert closest == {STR: 3, f"{STR}.RRDY": 50, "dsp.I2CA.I2CSTR.bb": 3}
    with pytest.raises(NotInRun, match=r"did you mean I2C-A\.I2CSTR"):
        races(run, "I2C-A.I2CSRT")


def test_a_read_that_names_a_field_is_compared_with_that_field_only():
    """BB changes one cycle after RRDY is read. Only a read of the whole register could have seen that."""
    changes = flag(101, "BB", 1), flag(140, "RRDY", 1)
    for field, closest in (("RRDY", 40), ("BB", 1), ("", 1), ("SCD", None)):
        (place,) = races(by_hand(read(100, field=field), *changes)).places
        assert ((place.before and place.before.cycles), place.alone) == (closest, int(closest is None)), field


def test_reads_of_several_fields_at_one_place_are_each_compared_with_their_field():
    looks = read(100, field="RRDY"), read(105, field="SCD")
    (place,) = races(by_hand(*looks, flag(107, "RRDY", 1), flag(165, "SCD", 1))).places
    assert (place.before, place.reads) == (NearMiss(7, 100 * CYCLE, "RRDY"), 2)
    assert (place.histogram, place.alone) == ((0, 1, 1, 0, 0, 0), 0)


def test_a_read_modify_write_writes_all_fields_back_and_is_compared_with_all():
    modify = read(100, field="SCD"), write(102, SCD, field="SCD")
    (place,) = races(by_hand(flag(97, "RRDY", 1), *modify)).places
    assert place.after and (place.after.cycles, place.after.field) == (3, "RRDY")
    (place,) = races(by_hand(flag(97, "RRDY", 1), modify[0])).places  # a read of SCD
    assert place.after is None
    (place,) = races(by_hand(*modify)).places  # nothing changes
    assert (place.reads, place.alone) == (1, 1)


def test_a_read_modify_write_of_an_image_can_be_several_instructions_of_a_line():
    """MOV AL,@I2CSTR; OR AL,#0x20; MOV @I2CSTR,AL are the instructions of one line of C."""
    rises = flag(97, "RRDY", 1), flag(101, "RRDY", 0), flag(101, "RRDY", 1)
    one = races(by_hand(*rises, read(100, place="_f (m.c:7, 0x009001)"), write(102, SCD, place="_f (m.c:7, 0x009004)")))
    assert [(modify.place, modify.count) for modify in one.modifies] == [("_f (m.c:7, 0x009004)", 1)]
    two = races(by_hand(*rises, read(100, place="_f (m.c:7, 0x009001)"), write(102, SCD, place="_f (m.c:9, 0x009004)")))
    assert two.modifies == ()


def test_races_of_one_field_include_only_reads_of_it():
    run = by_hand(read(100, field="RRDY"), flag(103, "BB", 1), read(110, place="g:2"))
    assert [(p.place, p.reads, p.closest) for p in races(run, f"{STR}.BB").places] == [("g:2", 1, 7)]
    assert [(p.place, p.reads, p.closest) for p in races(run, f"{STR}.RRDY").places] == [
        ("f:1", 1, None),
        ("g:2", 1, None),
    ]


def test_polls_of_a_skipped_wait_are_reconstructed():
    run = by_hand(read(100), read(110), flag(507, "RRDY", 1), read(510, RRDY))
    (place,) = races(run).places
    assert (place.before and place.before.cycles, place.after and place.after.cycles) == (7, 3)
    assert (place.reads, place.polls, place.unplaced) == (3, 1, 0)


@given(period=st.integers(10, 60), passes=st.integers(3, 200), into=st.floats(0, 1), second=st.sampled_from([0, 4, 7]))
def test_reconstructed_polls_are_those_that_were_made(period: int, passes: int, into: float, second: int):
    """A pass of the wait has one read, or two if `second` is not 0. The first read after a change ends the wait."""
    assume(not second or (period - second) % second)  # otherwise it could also be a shorter loop with one read
    in_pass = [0, second] if second else [0]
    grid = [100 + n * period + offset for n in range(passes) for offset in in_pass]
    shown = 2 * len(in_pass)
    changed = grid[shown - 1] + 1 + int(into * (grid[-1] - grid[shown - 1] - 1))
    saw = next(at for at in grid if at >= changed)
    missed = max(at for at in grid if at < changed)
    run = by_hand(*(read(at) for at in grid[:shown]), flag(changed, "RRDY", 1), read(saw, RRDY), end=20_000)
    (place,) = races(run).places
    assert (place.before and place.before.cycles, place.after and place.after.cycles) == (
        changed - missed,
        saw - changed,
    )


@given(
    period=st.integers(12, 60),
    passes=st.integers(7, 200),
    into=st.floats(0, 1),
    offset=st.sampled_from([4, 7]),
    waited_for=st.sampled_from([0, 1]),
)
def test_reconstructed_polls_are_those_of_the_field_that_changed(
    period: int, passes: int, into: float, offset: int, waited_for: int
):
    """`XRDY or SCD`: a pass reads XRDY and, `offset` cycles later, SCD. Either can end the wait."""
    assume((period - offset) % offset)
    names = "XRDY", "SCD"
    grid = [(100 + n * period + offset * second, second) for n in range(passes) for second in (0, 1)]
    own = [at for at, second in grid if second == waited_for]
    first = 2 * 5  # reads before polls are skipped: enough to determine the length of a pass
    changed = grid[first][0] + 1 + int(into * (own[-1] - grid[first][0] - 1))
    saw = next(at for at in own if at >= changed)
    missed = max(at for at in own if at < changed)
    looks = [read(at, field=names[second]) for at, second in grid]
    recorded = [
        *looks[: first + 1],
        *(look for look in looks[first + 1 :] if changed <= look[0] <= saw),
    ]  # the others were skipped by the simulator
    rows = [*recorded, flag(changed, names[waited_for], 1)]
    (place,) = races(by_hand(*sorted(rows, key=lambda row: (row[0], row[1] is Kind.ACCESS)), end=20_000)).places
    assert (place.before and place.before.cycles, place.after and place.after.cycles) == (
        changed - missed,
        saw - changed,
    )


def test_a_gap_that_is_off_the_grid_is_not_filled():
    run = by_hand(read(100), read(110), flag(507, "RRDY", 1), read(513, RRDY))
    (place,) = races(run).places
    assert (place.before and place.before.cycles, place.polls, place.unplaced) == (397, 0, 1)
    assert "1 skipped waits" in text(races(run))


def test_reads_with_another_access_between_them_are_not_a_wait():
    run = by_hand(read(100), read(110), write(200, place="g:3"), flag(507, "BB", 1), read(510))
    (place,) = [place for place in races(run).places if place.place == "f:1"]
    assert (place.before and place.before.cycles, place.polls) == (397, 0)


@pytest.mark.parametrize(("between", "closest", "polls"), [(read, 7, 1), (write, 397, 0)])
def test_a_loop_of_an_image_is_a_wait_only_if_it_does_not_write(between, closest: int, polls: int):
    """The records of the two loops:

    cycle          100  104  110  114          507          510
    wait           R    R    R    R    polls   RRDY rises   R
    other loop     R    W    R    W            RRDY rises   R
    """
    first, second = "_f (m.c:7, 0x009001)", "_f (m.c:7, 0x009004)"
    passes = [row for at in (100, 110) for row in (read(at, place=first), between(at + 4, SCD, place=second))]
    run = by_hand(*passes, flag(507, "RRDY", 1), read(510, RRDY, place=first))
    (one,) = [place for place in races(run).places if place.place == first]
    assert (one.before and one.before.cycles, one.polls) == (closest, polls)


def poll_main(dsp: Dsp) -> None:
    start_i2c(dsp)
    i2c = dsp.module("I2C-A")
    i2c.I2COAR.all = ADDRESS
    i2c.I2CMDR.IRS = 1
    dsp.spin(lambda: i2c.I2CSTR.AAS == 1)
    while True:
        i2c.I2CCNT.all = 1
        dsp.spin_either(lambda: i2c.I2CSTR.RRDY == 1, lambda: i2c.I2CSTR.SCD == 1)
        if i2c.I2CDRR.all == 3:
            return


def test_the_closest_reads_are_the_same_with_and_without_skipped_polls(monkeypatch: pytest.MonkeyPatch):
    found = [
        races(ran(monkeypatch, poll_main, skip_polls=skip, **asks(write="010203", count=0)), STR)
        for skip in (True, False)
    ]
    shaves = [{p.place: (p.before, p.after) for p in each.places} for each in found]
    assert shaves[0] == shaves[1] and len(shaves[0]) == 2
    assert sum(p.polls for p in found[0].places) > 0 == sum(p.polls for p in found[1].places)
    assert not any(p.unplaced for p in found[0].places)


def drop(i2c: Any) -> None:
    i2c.I2CSTR.SCD = 1


def test_a_flag_cleared_along_with_another_and_never_read_is_lost(monkeypatch: pytest.MonkeyPatch):
    def main(dsp: Dsp) -> None:
        start_i2c(dsp)
        i2c = dsp.module("I2C-A")
        i2c.I2COAR.all = ADDRESS
        i2c.I2CMDR.IRS = 1
        dsp.compute(180_000)  # 1.2 ms: after the byte, before the STOP
        drop(i2c)

    found = races(ran(monkeypatch, main, **asks(write="0102", count=0)))
    (modify,) = found.modifies
    (lost,) = modify.flags
    assert (modify.place, modify.meant, lost.flag, lost.along, lost.unseen) == (line_of(drop), ("SCD",), "RRDY", 1, 1)
    assert found.lost == 1 and "RRDY was cleared along with it 1 time, 1 of them never read" in text(found)


@pytest.mark.parametrize(("cleared", "lost"), [(True, 1), (False, 0)])
def test_a_flag_set_between_read_and_write_is_lost_if_the_write_clears_it(cleared: bool, lost: int):
    rows = [flag(50, "RRDY", 1), flag(60, "RRDY", 0), read(100, RRDY), flag(101, "RRDY", 1), write(102, RRDY | SCD)]
    run = by_hand(*rows, *([flag(102, "RRDY", 0, cause=5)] if cleared else []))
    (modify,) = races(run).modifies
    assert [(flag.rose, flag.lost_between) for flag in modify.flags] == [(1, lost)]
    assert races(run).lost == lost


def test_a_field_of_several_bits_counts_as_one_flag():
    """`PIEACK |= 0x80` acknowledges group 1 along with group 8, which is not reported."""
    access = [(100, Kind.ACCESS, "dsp", "R PIE.PIEACK", 0x81, "f:1", 0)]
    access += [(102, Kind.ACCESS, "dsp", "W PIE.PIEACK", 0x81, "f:1", 0)]
    changes = [
        (cycle, Kind.FLAG, "dsp.PIE", "PIEACK.PIEACK", value, "", 0) for cycle, value in ((10, 0x80), (20, 0x81))
    ]
    found = races(by_hand(*changes, *access, (102, Kind.FLAG, "dsp.PIE", "PIEACK.PIEACK", 0, "", 4)), "PIE.PIEACK")
    (modify,) = found.modifies
    assert (modify.meant, modify.flags, found.lost) == (("PIEACK",), (), 0)


def test_a_write_that_clears_a_flag_that_was_read_loses_nothing():
    run = by_hand(flag(50, "RRDY", 1), read(80, RRDY, place="look:9"), read(100, RRDY), write(102, RRDY | SCD))
    assert races(run).lost == 0
    later = by_hand(*_seen(), flag(102, "RRDY", 0, cause=4))
    assert (races(later).lost, races(later).along) == (0, 1)


def _seen() -> list[tuple[Any, ...]]:
    return [flag(50, "RRDY", 1), read(80, RRDY, place="look:9"), read(100, RRDY), write(102, RRDY | SCD)]


def test_a_flag_set_before_the_recording_began_is_not_reported_as_unread():
    run = by_hand(read(100, RRDY), write(102, RRDY | SCD), flag(102, "RRDY", 0, cause=2))
    ((rrdy,),) = [modify.flags for modify in races(run).modifies]
    assert (rrdy.flag, rrdy.along, rrdy.unseen, races(run).lost) == ("RRDY", 1, 0, 0)


def test_the_json_has_the_same_counts():
    run = by_hand(*_seen(), flag(102, "RRDY", 0, cause=4))
    found = as_json(races(run))
    assert (found["lost"], found["cleared_along"], found["closest"]) == (0, 1, races(run).closest)
    assert sum(sum(place["histogram"]) + place["alone"] for place in found["places"]) == 2


def test_a_run_without_status_reads_is_reported_as_such():
    assert "no read of a status register" in text(races(by_hand()))


@pytest.mark.parametrize("lands", [2, 4])
@pytest.mark.parametrize("phase", range(16))
def test_a_read_modify_write_is_found_with_a_service_routine_between_read_and_write(
    monkeypatch: pytest.MonkeyPatch, lands: int, phase: int
):
    """A timer interrupts before, during or after `SCD = 1`; its routine begins with a read of the PIE."""

    def ticked() -> None:
        assert pie.PIEIFR1.INTx7 == 0
        pie.PIEACK.all = 1

    def main(dsp: Dsp) -> None:
        nonlocal pie
        pie, timer, i2c = dsp.module("PIE"), dsp.module("TIMER0"), dsp.module("I2C-A")
        timer.PRD.all = 200
        start_pie(dsp, {"TINT0": ticked})
        timer.TCR.all = 0x4020  # TIE, TRB
        dsp.compute(192 + phase)
        drop(i2c)
        dsp.compute(500)

    pie: Any = None
    program = Firmware("under test", lambda dsp, settings: main(dsp), None)
    monkeypatch.setattr(unit_module, "load_firmware", lambda name: program)
    system = {"system": {"write_lands": lands}}
    unit = {"firmware": "under test", "modules": ["I2C-A", "TIMER0"], "options": system}
    run = recorded(case("10 us", unit={"dsp": unit}))
    (modify,) = races(run, STR).modifies
    assert (modify.place, modify.count, modify.meant) == (line_of(drop), 1, ("SCD",))


def test_accesses_of_a_service_routine_do_not_separate_a_read_from_its_write():
    entered = 101, Kind.IRQ, "dsp", "TINT0", 1, "ticked:1", 0
    of_routine = [(101, Kind.ACCESS, "dsp", f"R PIE.PIEIFR{n}", 0, "ticked:2", 2) for n in range(1, 6)]
    run = by_hand(read(100, RRDY, field="SCD"), entered, *of_routine, write(102, RRDY | SCD, field="SCD"))
    (modify,) = races(run, STR).modifies
    assert (modify.count, modify.meant) == (1, ("SCD",))

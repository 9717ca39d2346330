"""Causes of a record: the last change of the field that was read, read-modify-writes, service routines that delayed the
firmware, and the parties that hold a line low.
"""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.core.records import Kind
from periph_sim.records.cause_trace.causes import Link, end_of_walk, walk_back
from periph_sim.records.cause_trace.why import as_json, text, why
from periph_sim.records.races import races
from periph_sim.records.record_text import happened
from periph_sim.records.run import Run
from periph_sim.scene.case.load import load
from tests.records.scenes import CYCLE, by_hand, flag, read, recorded, write
from tests.scene.runs import TIMING

CNT = "I2C-A.I2CCNT"
SDIR, XRDY, RRDY, SCD, NACK = 0x4000, 0x0010, 0x0008, 0x0020, 0x0002


def count(cycle: int, place: str = "f:9", routine: int = 0) -> tuple[Any, ...]:
    """A write of I2CCNT."""
    return cycle, Kind.ACCESS, "dsp", f"W {CNT}", 6, place, routine


def counted(cycle: int, cause: int) -> tuple[Any, ...]:
    """The change of I2CCNT that the write with the number `cause` made."""
    return cycle, Kind.FLAG, "dsp.I2C-A", "I2CCNT.ICDC", 6, "", cause


def irq(cycle: int, value: int, cause: int = 0) -> tuple[Any, ...]:
    return cycle, Kind.IRQ, "dsp", "SCIRXINTA", value, "sci:7" if value else "", cause


def walk(*rows: tuple[Any, ...]) -> list[Link]:
    """Walk back from the last of these records to its causes."""
    run = by_hand(*rows)
    return list(walk_back(run, len(rows) - 1, 8))


def numbers(steps: list[Link]) -> list[str]:
    """Numbers of the records of a walk; records shown aside are in parentheses."""
    return [f"({step.record.number})" if step.aside else str(step.record.number) for step in steps]


# Hand-made records -------------------------------------------------------------------------


def test_the_cause_of_a_read_is_the_last_change_of_the_field_that_it_names():
    """Record 1 sets SCD long before, 2 sets XRDY, 3 sets BB. Then each field is read, and the whole register."""
    changes = flag(10, "SCD", 1), flag(500, "XRDY", 1), flag(600, "BB", 1)
    for field, cause in (("SCD", 1), ("XRDY", 2), ("BB", 3), ("", 3)):
        steps = walk(*changes, read(610, 0x1030, field), count(620), counted(620, 5))
        assert numbers(steps) == ["6", "5", "4", str(cause)], field


def test_the_cause_of_a_flag_cleared_by_a_read_modify_write_is_the_change_that_its_read_saw():
    """The firmware clears NACK. SCD was read as 1, so it is written back as 1 and cleared."""
    steps = walk(flag(5, "SCD", 1), read(10, SCD, "NACK"), write(12, SCD | NACK, "NACK"), flag(12, "SCD", 0, 3))
    assert numbers(steps) == ["4", "3", "(2)", "1"]


def test_a_change_after_the_read_is_not_a_cause():
    steps = walk(read(100, 0, "SCD"), flag(101, "SCD", 1), count(110), counted(110, 3))
    assert numbers(steps) == ["4", "3", "1"]


def test_the_cause_of_a_write_is_the_read_that_saw_the_newest_change_and_a_later_read_is_aside():
    """The wait ends because SCD is set. NACK, which was set before, is read between the wait and the write."""
    steps = walk(
        flag(100, "NACK", 1),
        flag(200, "SCD", 1),
        read(210, SCD | NACK, "SCD", "wait:3"),
        read(220, SCD | NACK, "NACK", "main:4"),
        count(230),
        counted(230, 5),
    )
    assert numbers(steps) == ["6", "5", "(4)", "(1)", "3", "2"]
    assert steps[3].of == steps[2].row


def test_only_a_read_in_the_same_routine_is_a_cause_however_old_it_is():
    before = flag(100, "SCD", 1), read(110, SCD, "SCD"), irq(120, 1), read(125, SCD, "SCD", "sci:8", 3), irq(130, 0, 3)
    assert numbers(walk(*before, count(140), counted(140, 6)))[:4] == ["7", "6", "(5)", "2"]
    assert numbers(walk(*before, count(2000), counted(2000, 6))) == ["7", "6", "(5)", "2", "1"]


def test_the_read_of_a_read_modify_write_and_the_flag_that_it_wrote_back_are_aside():
    """SDIR is set before the read-modify-write `SCD = 1`. SDIR is read as 1, so 1 is written back, which clears it."""
    rows = (
        flag(100, "RRDY", 1),
        read(110, RRDY, "RRDY", "wait:3"),
        flag(115, "SDIR", 1),
        read(120, SDIR | RRDY, "SCD"),
        write(122, SDIR | RRDY | SCD, "SCD"),
        flag(122, "SDIR", 0, 5),
    )
    steps = walk(*rows)
    assert numbers(steps) == ["6", "5", "(4)", "(3)", "2", "1"]
    assert [step.because for step in steps[2:4]] == [
        "the read of this read-modify-write",
        "SDIR as that read saw it, and the write gave it back",
    ]
    lost = races(by_hand(*rows))
    assert (lost.lost, [flag.flag for flag in lost.modifies[0].flags if flag.unseen]) == (1, ["SDIR"])


def test_the_read_of_a_read_modify_write_is_not_a_cause_of_its_write():
    """IRS, set long before, is also read when TRX is written, but that does not explain the write."""
    mode = (90, Kind.FLAG, "dsp.I2C-A", "I2CMDR.IRS", 1, "", 0)
    modify = [
        (120 + n, Kind.ACCESS, "dsp", f"{way} I2C-A.I2CMDR", 0x20, "f:5", 0, "TRX") for n, way in ((0, "R"), (2, "W"))
    ]
    steps = walk(mode, *modify, count(130), counted(130, 4))
    assert numbers(steps) == ["5", "4"]
    assert numbers(walk(mode, *modify, (122, Kind.FLAG, "dsp.I2C-A", "I2CMDR.TRX", 1, "", 3))) == ["4", "3", "(2)"]


def test_the_read_of_a_posted_write_is_found_when_another_access_is_between_them():
    """The CPU continues while a posted write is in progress."""
    other = 121, Kind.ACCESS, "dsp", "R SYS.PCLKCR0", 0, "f:2", 0
    steps = walk(read(120, 0, "SCD"), other, write(122, SCD, "SCD"), flag(122, "SCD", 0, 3))
    assert numbers(steps)[:3] == ["4", "3", "(1)"]


def test_a_service_routine_that_ended_between_flag_and_read_delayed_the_read():
    steps = walk(
        flag(100, "RRDY", 1),
        irq(90, 1),
        irq(30_090, 0, 2),
        read(30_100, RRDY, "RRDY"),
        count(30_110),
        counted(30_110, 5),
    )
    assert numbers(steps) == ["6", "5", "4", "(3)", "1"]
    assert steps[3].because == "held the firmware up for 200 us (30000 cycles)" and steps[3].of == steps[2].row


def test_a_service_routine_between_read_and_write_is_aside():
    """The service routine takes 1900 of the 2000 cycles between read and write."""
    flags = flag(90, "SCD", 1), read(100, SCD, "SCD")
    steps = walk(*flags, irq(150, 1), irq(2050, 0, 3), count(2100), counted(2100, 5))
    assert numbers(steps) == ["6", "5", "(4)", "2", "1"]


def test_a_nested_service_routine_delays_only_the_routine_that_it_interrupted():
    outer = 100, Kind.IRQ, "dsp", "TINT0", 1, "timer:1", 0
    ended = 900, Kind.IRQ, "dsp", "TINT0", 0, "", 2
    inner = flag(90, "SCD", 1), outer, irq(110, 1, 2), irq(600, 0, 3), read(700, SCD, "SCD", "timer:5", 2)
    assert numbers(walk(*inner, count(710, "timer:6", 2), counted(710, 6))) == ["7", "6", "5", "(4)", "(2)", "1"]
    steps = walk(*inner, ended, read(950, SCD, "SCD"), count(960), counted(960, 8))
    assert numbers(steps) == ["9", "8", "7", "(6)", "1"]


def test_of_many_service_routines_the_three_longest_are_aside():
    lengths = 30, 50, 10, 40, 20
    rows, at = [flag(10, "SCD", 1)], 20
    for length in lengths:
        rows += [irq(at, 1), irq(at + length, 0, len(rows) + 1)]
        at += 100
    steps = walk(*rows, read(600, SCD, "SCD"), count(610), counted(610, 13))
    assert numbers(steps) == ["14", "13", "12", "(9)", "(5)", "(3)", "1"]


def test_a_flag_that_was_read_as_0_was_not_written_back():
    """RRDY was read and written as 0. The write of SCD clears it only by its effect on the module."""
    steps = walk(flag(50, "RRDY", 1), read(120, 0, "SCD"), write(122, SCD, "SCD"), flag(122, "RRDY", 0, 3))
    assert numbers(steps) == ["4", "3", "(2)"]


def test_reads_of_two_fields_at_one_place_are_distinguished():
    """`NACK or SCD`: the last pass of the wait reads NACK and then SCD. The change of NACK is the newer one."""
    changes = flag(50, "SCD", 1), flag(60, "NACK", 1)
    steps = walk(*changes, read(70, NACK, "NACK"), read(75, SCD, "SCD"), count(80), counted(80, 5))
    assert numbers(steps) == ["6", "5", "(4)", "(1)", "3", "2"]


def test_a_read_of_an_unknown_register_has_no_cause():
    look = 70, Kind.ACCESS, "dsp", "R I2C-A.I2CNEW", 0, "f:1", 0
    assert numbers(walk(flag(50, "SCD", 1), look, count(80), counted(80, 3))) == ["4", "3", "2"]


def test_a_read_modify_write_of_an_unknown_register_writes_no_flag_back():
    modify = [(70 + n, Kind.ACCESS, "dsp", f"{way} I2C-A.I2CNEW", 0, "f:1", 0) for n, way in ((0, "R"), (2, "W"))]
    assert numbers(walk(flag(50, "SCD", 1), *modify, flag(72, "SCD", 0, 3))) == ["4", "3", "(2)"]


def test_a_service_routine_that_ended_before_the_flag_delayed_nothing():
    steps = walk(irq(10, 1), irq(90, 0, 1), flag(100, "RRDY", 1), read(110, RRDY, "RRDY"), count(120), counted(120, 5))
    assert numbers(steps) == ["6", "5", "4", "3"]


def test_a_service_routine_does_not_delay_itself_and_its_entry_is_aside():
    """The flag is set, the interrupt is entered, the routine reads the flag and writes."""
    steps = walk(
        flag(100, "RRDY", 1),
        irq(110, 1),
        read(120, RRDY, "RRDY", "sci:8", 2),
        count(130, "sci:9", 2),
        counted(130, 4),
    )
    assert numbers(steps) == ["5", "4", "3", "(2)", "1"]


def test_the_cause_of_an_access_without_an_earlier_read_is_the_entry_of_its_service_routine():
    """The access is a write, a read-modify-write, whose read is aside, or a read of a field that never changed."""
    assert numbers(walk(irq(110, 1), count(130, "sci:9", 1), counted(130, 2))) == ["3", "2", "1"]
    modify = read(120, 0, "SCD", "sci:8", 1), write(122, SCD, "SCD", "sci:8", 1)
    assert numbers(walk(irq(110, 1), *modify, flag(122, "SCD", 0, 3))) == ["4", "3", "(2)", "1"]
    look = read(120, 0, "SCD", "sci:8", 1)
    assert numbers(walk(irq(110, 1), look, count(130, "sci:9", 1), counted(130, 3))) == ["4", "3", "2", "1"]


def test_the_cause_of_a_nested_interrupt_is_its_own_request():
    asked = 105, Kind.FLAG, "dsp.PIE", "PIEIFR9.INTx1", 1, "", 0
    outer = 100, Kind.IRQ, "dsp", "TINT0", 1, "timer:1", 0
    steps = walk(outer, asked, irq(120, 1, 1))
    assert numbers(steps) == ["3", "2"]


def test_a_cause_in_the_first_row_is_found_and_the_walk_ends_there():
    run = by_hand(flag(1, "SCD", 1), read(2, SCD, "SCD"), count(3), counted(3, 3))
    for depth in (3, 8, 1000):
        assert numbers(list(walk_back(run, 3, depth))) == ["4", "3", "2", "1"]
    assert why(run, "I2CCNT.ICDC@1us").back[-1].row == 0


def test_the_cause_of_the_end_of_an_interrupt_is_its_entry():
    steps = walk(irq(10, 1), irq(20, 0, 1))
    assert [(step.record.number, step.known, step.because) for step in steps] == [
        (2, "", ""),
        (1, "recorded", "caused it"),
    ]
    assert numbers(walk(irq(10, 1), (20, Kind.IRQ, "dsp", "USER1", 1, "", 1))) == [
        "2",
        "1",
    ]  # not an interrupt of the PIE


def asked(cycle: int, line: str, value: int = 1, cause: int = 0) -> tuple[Any, ...]:
    return cycle, Kind.FLAG, "dsp.PIE", f"PIEIFR{line}", value, "", cause


def module(cycle: int, where: str, what: str, value: int = 1) -> tuple[Any, ...]:
    return cycle, Kind.FLAG, f"dsp.{where}", what, value, "", 0


@pytest.mark.parametrize(
    ("line", "before", "cause"),
    [
        ("9.INTx1", [module(100, "SCI-A", "SCIFFRX.RXFFINT")], 1),
        ("9.INTx1", [module(100, "SCI-A", "SCIRXST.RXRDY"), module(99, "SCI-A", "SCICTL2.TXRDY")], 1),
        (
            "9.INTx1",
            [module(90, "SCI-A", "SCIFFRX.RXFFINT"), module(100, "SCI-A", "SCIFFRX.RXFFIENA")],
            2,
        ),  # the latest one
        ("9.INTx1", [module(100, "SCI-A", "SCIFFRX.RXFFINT", 0)], None),
        ("9.INTx1", [module(100, "SCI-B", "SCIFFRX.RXFFINT")], None),
        ("9.INTx3", [module(100, "SCI-B", "SCIFFRX.RXFFINT")], 1),
        ("9.INTx2", [module(100, "SCI-A", "SCICTL2.TXRDY")], 1),
        ("1.INTx7", [module(100, "TIMER0", "TCR.TIF")], 1),
        ("9.INTx1", [module(86, "SCI-A", "SCIFFRX.RXFFINT")], 1),  # 16 cycles before
        ("9.INTx1", [module(85, "SCI-A", "SCIFFRX.RXFFINT")], None),
        ("12.INTx8", [module(100, "SCI-A", "SCIFFRX.RXFFINT")], None),
    ],
)
def test_the_cause_of_a_pie_flag_is_the_latest_field_that_requested_it(line: str, before: list[Any], cause: int | None):
    assert numbers(walk(*before, asked(102, line))) == [str(len(before) + 1), *([str(cause)] if cause else [])]


def test_the_cause_of_a_cleared_pie_flag_or_of_another_register_is_the_recorded_one():
    rose = module(100, "SCI-A", "SCIFFRX.RXFFINT")
    assert numbers(walk(irq(1, 1), rose, asked(102, "9.INTx1", 0, 1))) == ["3", "1"]
    assert numbers(walk(irq(1, 1), rose, module(102, "PIE", "PIECTRL.ENPIE"))) == ["3"]


@pytest.mark.parametrize(
    ("depth", "records", "end"),
    [
        (2, ["5", "4", "3"], "2 causes were asked for; --depth gives more"),
        (3, ["5", "4", "3", "1"], "3 causes were asked for; --depth gives more"),
        (4, ["5", "4", "3", "1"], "no record of a cause of it"),
    ],
)
def test_a_walk_ends_after_the_requested_number_of_causes(depth: int, records: list[str], end: str):
    run = by_hand(flag(1, "SCD", 1), flag(2, "BB", 1), read(3, SCD, "SCD"), count(4), counted(4, 4))
    steps = list(walk_back(run, 4, depth))
    assert (numbers(steps), end_of_walk(run, steps, depth)) == (records, end)
    assert end_of_walk(run, [], depth) == ""


def test_a_record_that_names_itself_or_a_later_one_has_no_cause():
    assert numbers(walk(flag(1, "SCD", 1, 1))) == ["1"]
    assert numbers(list(walk_back(by_hand(flag(1, "SCD", 1, 2), flag(2, "SCD", 0, 1)), 0, 8))) == ["1"]


# Wires -----------------------------------------------------------------------------


def edge(cycle: int, level: int, who: str, cause: int = 0) -> tuple[Any, ...]:
    return cycle, Kind.EDGE, "SCL", "level", level, who, cause


def hold(cycle: int, who: str, cause: int = 0) -> tuple[Any, ...]:
    return cycle, Kind.HOLD, "SCL", "held", 0, who, cause


LOW = (
    (5, Kind.BUS, "controller", "address", 0x68 << 2 | 2, "gyroscope", 0),
    edge(10, 0, "controller"),
    hold(20, "dsp.SCLA, controller", 2),
    hold(30, "dsp.SCLA"),
    edge(90, 1, ""),
)


@pytest.mark.parametrize(
    ("cycle", "held", "records"),
    [
        (15, "controller", ["2", "1"]),
        (25, "dsp.SCLA and controller", ["3", "2", "1"]),
        (50, "dsp.SCLA", ["4", "3", "2", "1"]),
    ],
)
def test_an_answer_has_the_parties_that_hold_a_line_and_the_one_that_pulled_it_first(
    cycle: int, held: str, records: list[str]
):
    answer = why(by_hand(*LOW), f"SCL@{cycle * CYCLE // 3} ns")
    assert (answer.since, " and ".join(answer.held_by), answer.pulled_by) == (10 * CYCLE, held, ("controller",))
    assert numbers(list(answer.back)) == records
    has_first = "pulled low first by controller, held now by" in text(answer)
    assert has_first == (held != "controller")
    assert as_json(answer)["held_by"] == held.split(" and ")


def test_the_first_party_holds_a_line_after_a_second_one_released_it():
    both = hold(20, "dsp.SCLA, controller", 2)
    answer = why(by_hand(*LOW[:2], both, hold(30, "controller"), edge(90, 1, "")), f"SCL@{50 * CYCLE // 3} ns")
    assert numbers(list(answer.back)) == ["4", "2", "1"]


def test_a_line_is_released_by_the_party_that_held_it_last():
    answer = why(by_hand(*LOW), "SCL@900ns")
    assert "SCL rises, released by dsp.SCLA" in text(answer) and answer.held_by == ()


# Recorded cases -----------------------------------------------------------------------


@pytest.fixture(scope="module")
def hang() -> Run:
    """A frame of the host ends during a read, and its routine takes 200 us. Then `SCD = 1` clears the unread SDIR."""
    changes = ["unit.dsp.settings.frame_cost=200 us", "host.first=4 ms", "controller.first=5 ms"]
    return recorded(load(TIMING / "imu_hil_published.toml", changes), "0.012")


def test_the_chain_of_a_cleared_scd_leads_to_the_stop_of_the_same_transfer():
    """The firmware waits for SCD and clears it by IRS = 0. The chain does not lead to the SCD of another transfer."""
    run = recorded(load(TIMING / "imu_hil_no_sdir.toml", []), "0.03")
    falls = run.rows(Kind.FLAG, "dsp.I2C-A", "I2CSTR.SCD")
    falls = falls[run.table.value[falls] == 0]
    assert len(falls) == 6
    models = 37_500  # cycles
    behind = []
    for fall in falls.tolist():
        steps = list(walk_back(run, fall, 3))
        rise = steps[-1].record
        assert happened(rise) == "I2C-A.I2CSTR.SCD set"
        behind.append(run.clock().cycles(rise.tick, steps[0].record.tick))
    near = [cycles for cycles in behind if cycles < 100]
    assert len(near) == 4 and all(models < cycles < models + 100 for cycles in behind if cycles not in near)


def test_a_flag_cleared_unread_is_explained_by_the_read_modify_write_and_the_service_routine_before_it(hang: Run):
    answer = why(hang, "I2C-A.I2CSTR.SDIR@6ms")
    words = [happened(step.record) for step in answer.back]
    assert words[0] == "I2C-A.I2CSTR.SDIR cleared"
    assert words[1].startswith("I2C-A.I2CSTR written") and words[1].endswith("(SCD = 1)")
    assert words[2].startswith("I2C-A.I2CSTR read") and "read-modify-write" in answer.back[2].because
    assert words[3] == "I2C-A.I2CSTR.SDIR set"
    routine = answer.back[words.index("SCIRXINTA left")]
    assert routine.because.startswith("held the firmware up for 200.")
    assert "I2CMDR.IRS" not in " ".join(words)


def test_races_reports_a_flag_cleared_unread(hang: Run):
    (modify,) = races(hang, "I2C-A.I2CSTR").modifies
    assert (modify.meant, modify.lost) == (("SCD",), 1)
    assert [(flag.flag, flag.along, flag.unseen) for flag in modify.flags] == [("SDIR", 1, 1), ("RRDY", 1, 0)]


def test_why_names_the_party_that_blocks_the_bus(hang: Run):
    answer = why(hang, "SCL@11ms")
    assert (answer.pulled_by, answer.held_by) == (("controller",), ("dsp.GPIO33",))
    assert answer.back[0].record.tick > answer.since

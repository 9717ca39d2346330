"""Differences of two traces: changed, missing and inserted events, and the events at which delays begin."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.traces.diff import matching as pair
from periph_sim.traces.diff.matching import Event, Group
from tests.traces.diff.runs import MHZ, diffed, differences, event, group

WRITE = "START 0, address 53 W 10, ACK 90, byte 32 100, ACK 180, STOP 195"
READ = "START 300, address 53 R 310, ACK 390, byte FB 400, ACK 480, byte FF 490, NACK 570, STOP 585"
BOTH = [group(WRITE), group(READ)]


def later(found: list[Group], by: int, since: int = 0) -> list[Group]:
    return [[e._replace(at=e.at + by * (e.at >= since)) for e in one] for one in found]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda t: t, []),
        (lambda t: t.replace("byte FB", "byte FC"), ["byte FB > byte FC"]),
        (lambda t: t.replace("ACK 390", "NACK 390"), ["ACK > NACK"]),
        (lambda t: t.replace("ACK 480, byte FF 490, ", ""), ["-ACK", "-byte FF"]),
        (lambda t: t.replace("byte FB 400", "byte FB 400, ACK 401, byte 11 405"), ["+ACK", "+byte 11"]),
        (lambda t: t.replace("address 53 R", "address 1E R"), ["address 53 R > address 1E R"]),
        (lambda t: t.replace("START 300", "repeated START 300"), ["START > repeated START"]),
        (lambda t: t.replace(", STOP 585", ""), ["-STOP"]),
        (lambda t: t.replace("byte FF 490", "cut byte 490"), ["byte FF > cut byte"]),
    ],
)
def test_changed_missing_and_inserted_events(change, said):
    assert differences(diffed(BOTH, [group(WRITE), group(change(READ))])) == said


def test_an_additional_or_missing_transfer():
    extra = group("START 200, address 1E W 210, NACK 290, STOP 295")
    more = [BOTH[0], extra, BOTH[1]]
    assert differences(diffed(BOTH, more)) == ["+START", "+address 1E W", "+NACK", "+STOP"]
    assert differences(diffed(more, BOTH)) == ["-START", "-address 1E W", "-NACK", "-STOP"]


def test_a_transfer_is_paired_with_the_most_similar_one():
    """Reads of three devices are compared with two refusals and a shorter read of the second device."""
    read = "START {0}, address {1} W {0}, ACK {0}, repeated START {0}, address {1} R {0}, ACK {0}, {2}STOP {0}"
    six = "".join(f"byte 0{n} {{0}}, ACK {{0}}, " for n in range(6))
    a = [group(read.format(at, address, six.format(at))) for at, address in ((0, "68"), (500, "53"), (900, "1E"))]
    refused = "START {0}, address 53 W {0}, NACK {0}, STOP {0}"
    b = [group(refused.format(0)), group(refused.format(200)), group(read.format(500, "53", "byte 00 500, NACK 500, "))]
    found = diffed(a, b)
    gone = [f"-{e.word}" for e in a[0]] + [f"+{e.word}" for e in b[0] + b[1]]
    shorter = ["ACK > NACK"] + [word for n in range(1, 6) for word in (f"-byte 0{n}", "-ACK")]
    assert differences(found) == gone + shorter + [f"-{e.word}" for e in a[2]]
    assert not found.late


def test_two_transfers_instead_of_one_with_a_repeated_start():
    """If most events are equal, they are paired across the bounds of transfers."""
    one = [group("START 0, address 53 W 1, ACK 2, byte 32 3, ACK 4, repeated START 5, address 53 R 6, ACK 7, STOP 8")]
    two = [
        group("START 0, address 53 W 1, ACK 2, byte 32 3, ACK 4, STOP 5"),
        group("START 6, address 53 R 7, ACK 8, STOP 9"),
    ]
    assert differences(diffed(one, two)) == ["+STOP", "repeated START > START"]


def test_a_constant_shift_is_an_offset_and_not_a_difference():
    found = diffed(BOTH, later(BOTH, 12_345))
    assert found.equal and found.offset == 12_345 and not found.change_points
    assert {kind.worst.later for kind in found.kinds} == {0}


def test_an_interrupt_three_microseconds_late_is_one_change_point():
    found = diffed(BOTH, later(later(BOTH, 3, since=400), 50))
    assert not found.equal and differences(found) == []
    (point,) = found.change_points
    assert (point.entry.a.word, point.before.a.word, point.step) == ("byte FB", "ACK", 3)
    assert [entry.later for entry in found.late] == [3] * 5, "later events have the same delay"
    assert found.first is point.entry


def test_a_temporary_delay_has_two_change_points():
    found = diffed(BOTH, later(later(BOTH, 7, since=100), -7, since=300))
    assert [(p.entry.a.word, p.step) for p in found.change_points] == [("byte 32", 7), ("START", -7)]


def test_differences_up_to_the_tolerance_are_ignored():
    moved = later(BOTH, 3, since=400)
    assert diffed(BOTH, moved, Fraction(3, 10**6)).equal
    assert not diffed(BOTH, moved, Fraction(29, 10**7)).equal


def test_the_default_tolerance_is_one_sample_of_each_capture():
    """At 1 MHz and 4 MHz, the tolerance is 1.25 us."""
    fast = [[e._replace(at=4 * e.at + (e.at >= 400)) for e in one] for one in BOTH]
    assert diffed(BOTH, fast, rates=(MHZ, 4 * MHZ)).equal
    assert diffed(BOTH, later(fast, 4, since=1600), rates=(MHZ, 4 * MHZ)).equal is True
    assert diffed(BOTH, later(fast, 5, since=1600), rates=(MHZ, 4 * MHZ)).equal is False


def test_rates_without_a_common_multiple_are_exact():
    """The rates are 24 MHz and 10 MHz. 1/24 us is not a whole number of nanoseconds."""
    a = [[e._replace(at=24 * e.at) for e in one] for one in BOTH]
    b = [[e._replace(at=10 * e.at) for e in one] for one in BOTH]
    assert diffed(a, b, Fraction(0), (24 * MHZ, 10 * MHZ)).equal


def test_a_slow_clock_makes_a_change_point_each_time_it_exceeds_the_tolerance():
    b = [[e._replace(at=e.at + e.at // 100) for e in one] for one in BOTH]
    assert [point.step for point in diffed(BOTH, b, Fraction(2, 10**6)).change_points] == [3]


def test_each_kind_of_event_has_a_summary():
    found = {kind.kind: kind for kind in diffed(BOTH, later(BOTH, 4, since=480)).kinds}
    assert list(found) == ["START", "address", "ACK", "byte", "STOP", "NACK"]
    assert (found["ACK"].both, found["ACK"].median, found["ACK"].worst.later) == (4, 0, 4)
    assert (found["byte"].both, found["byte"].median, found["byte"].worst.a.word) == (3, 0, "byte FF")
    assert (found["STOP"].median, found["STOP"].worst.later) == (0, 4)


def test_traces_without_common_events_have_no_offset():
    found = diffed(BOTH, [])
    assert found.offset is None and len(found.missing) == 14 and not found.equal


# Properties of any list of transfers.

BYTES = st.integers(0, 255).map(lambda value: f"byte {value:02X}")


@st.composite
def transfer(draw) -> list[str]:
    words = ["START"]
    for number in range(draw(st.integers(1, 2))):
        words += ["repeated START"] * (number > 0)
        words += [f"address {draw(st.sampled_from([0x1E, 0x53, 0x68])):02X} {draw(st.sampled_from('RW'))}", "ACK"]
        for byte in draw(st.lists(BYTES, max_size=4)):
            words += [byte, draw(st.sampled_from(["ACK", "NACK"]))]
    return [*words, "STOP"]


@st.composite
def run(draw) -> list[Group]:
    at = draw(st.integers(0, 1000))
    found: list[Group] = []
    for words in draw(st.lists(transfer(), min_size=1, max_size=6)):
        one: list[Event] = []
        for word in words:
            one.append(event(word, at))
            at += draw(st.integers(2, 50))
        found.append(one)
    return found


def place(data: st.DataObject, groups: list[Group]) -> tuple[int, int]:
    which = data.draw(st.integers(0, len(groups) - 1))
    return which, data.draw(st.integers(0, len(groups[which]) - 1))


@given(run())
def test_a_trace_does_not_differ_from_itself(a):
    found = diffed(a, a, Fraction(0))
    assert found.equal and found.first is None and len(found.entries) == sum(map(len, a))


@given(run(), st.integers(-500, 500))
def test_any_shift_is_an_offset(a, by):
    found = diffed(a, later(a, by, since=-1000), Fraction(0))
    assert found.equal and found.offset == by


@given(run(), st.data())
def test_a_delay_after_the_first_event_is_one_change_point(a, data):
    since = data.draw(st.sampled_from([e.at for one in a for e in one][1:]))
    found = diffed(a, later(a, 3, since), Fraction(0))
    assert [(point.entry.a.at, point.step) for point in found.change_points] == [(since, 3)]
    assert differences(found) == []


@given(run(), st.data())
def test_only_the_changed_event_is_found(a, data):
    which, where = place(data, a)
    b = [list(one) for one in a]
    was = b[which][where]
    b[which][where] = was._replace(word=f"{was.kind} of another kind")
    found = diffed(a, b, Fraction(0))
    assert differences(found) == [f"{was.word} > {was.kind} of another kind"]
    assert found.changed[0].a == was and not found.late


@given(run(), st.data())
def test_only_the_missing_event_is_found(a, data):
    """The missing event can be any of several consecutive equal events of the transfer."""
    which, where = place(data, a)
    b = [list(one) for one in a]
    gone = b[which].pop(where)
    found = diffed(a, [one for one in b if one])
    assert differences(found) == [f"-{gone.word}"]
    back = diffed([one for one in b if one], a)
    assert differences(back) == [f"+{gone.word}"]


@pytest.mark.parametrize("few", [5_000, 12, 0])
@given(run(), run())
def test_every_event_of_both_traces_is_in_the_diff_once_and_in_order(few, a, b):
    """This holds for each method: pairing events, similar transfers or, if there are many, transfers of one address."""
    before = pair.FEW_EVENTS, pair.FEW_GROUPS
    pair.FEW_EVENTS, pair.FEW_GROUPS = few, few // 6
    try:
        found = diffed(a, b)
    finally:
        pair.FEW_EVENTS, pair.FEW_GROUPS = before
    assert [entry.a for entry in found.entries if entry.a] == [e for one in a for e in one]
    assert [entry.b for entry in found.entries if entry.b] == [e for one in b for e in one]
    assert sum(entry.later is not None for entry in found.entries) == sum(kind.both for kind in found.kinds)


def test_many_transfers_without_an_equal_one_are_paired_by_their_addresses(monkeypatch):
    monkeypatch.setattr(pair, "FEW_EVENTS", 0)
    monkeypatch.setattr(pair, "FEW_GROUPS", 0)
    read = "START {0}, address {1} R {0}, ACK {0}, byte {2} {0}, {3}STOP {0}"
    a = [group(read.format(n, address, n + 10, f"NACK {n}, ")) for n, address in enumerate(["68", "53", "1E"])]
    b = [group(read.format(n, address, n + 20, "")) for n, address in enumerate(["68", "1E"])]
    gone = [f"-{event.word}" for event in a[1]]
    assert differences(diffed(a, b)) == ["byte 10 > byte 20", "-NACK", *gone, "byte 12 > byte 21", "-NACK"]

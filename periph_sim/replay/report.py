"""Result of a replay: the divergences of its events from those of the capture, with a verdict.

    expected, found --> compare --> Comparison: the first wrong byte, ACK, event, and the first wrong time

An event is compared by its text ("address 50 write", "ACK"), not by its time. A byte or an ACK with a wrong value does
not end the comparison, since later events still correspond to each other. Any other difference between texts does.

pass         everything judged is as in the capture
ambiguous    as pass, but some UART frames are not judged, because receivers may read them in different ways
not judged   nothing is proved: the capture requires nothing of the firmware, a serial line does not fit its format, or
             the first difference is certainly no error of the firmware
fail         something judged differs, the replay ended early, or a budget of a session is broken
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import zip_longest

from ..timing.verdict import Verdict
from ..traces.decode import i2c
from ..traces.decode.i2c_table import I2cRowKind
from ..traces.diff.align import align, numbered

NOTHING = "nothing more"

BYTE, ACK, EVENT, TIMING = "byte", "ACK", "event", "timing"
# FIRST maps each kind of divergence to the name that reports give to the first divergence of this kind.
FIRST = {
    BYTE: "first wrong byte",
    ACK: "first wrong ACK",
    EVENT: "first other divergence",
    TIMING: "first difference in time",
}

CONDITIONS = ("START", "repeated START", "STOP", NOTHING)


def at_text(seconds: float | None) -> str:
    """Return the time of an event as text, such as "at 0.001200 s"; "" if there is no event."""
    return "" if seconds is None else f"at {seconds:.6f} s"


@dataclass(frozen=True, slots=True)
class Happened:
    """An event as text.

    words: the text, such as "address 50 write".
    at: seconds since the capture began; None if unknown.
    due: the time at which a replay should have this event; None if this time is `at`.
    """

    words: str
    at: Fraction | None
    due: Fraction | None = None


@dataclass(frozen=True, slots=True)
class HistoryEntry:
    """An entry of the chip's history: a register field that changed, or a CPU access.

    at_s: seconds since the capture began.
    what: the field or the access, for example "I2C-A.I2CSTR.AAS" or "W I2C-A.I2CDXR".
    value: the field's new value, or the word that was read or written.
    """

    at_s: float
    what: str
    value: int


@dataclass(frozen=True, slots=True)
class Divergence:
    """A difference between the capture and the replay.

    index: the number of events before the divergence.
    expected, found: the event in the capture and in the replay, as text. If `kind` is TIMING, `found` states the
        difference in time.
    capture_s, replay_s: the times of these events in seconds since the capture began; None if there is no event.
    kind: a key of FIRST: BYTE, ACK, EVENT or TIMING.
    history: the changes of the chip's register fields, and the CPU accesses to its registers, around the divergence.
    cause: a phrase that names the causing statement of the firmware, or another cause; "" if unknown.
    """

    index: int
    expected: str
    found: str
    capture_s: float | None
    replay_s: float | None
    kind: str = EVENT
    history: tuple[HistoryEntry, ...] = ()
    cause: str = ""


@dataclass(frozen=True, slots=True)
class Comparison:
    """The result of comparing two lists of events.

    agreed: the number of events that occur in both lists in the same order.
    divergence: the first divergence that is not of kind TIMING; None if there is none.
    lag: the largest difference in time, in seconds, among the events before the first one whose text differs.
    ranked: the first divergence of each kind, in the order of the events, because an earlier one may cause a later one.
        TIMING is last, because a single stretch delays all later events.
    """

    agreed: int
    divergence: Divergence | None
    lag: Fraction
    ranked: tuple[Divergence, ...] = ()


def kind_of(words: str) -> str:
    """Return BYTE for the text of an address, data byte or word, ACK for ACK or NACK, and EVENT for any other event."""
    if words in CONDITIONS or words.startswith("cut off"):
        return EVENT
    return ACK if words in ("ACK", "NACK") else BYTE


def compare(expected: Sequence[Happened], found: Sequence[Happened], tolerance: Fraction | None = None) -> Comparison:
    """Compare two lists of events. A difference in length is a divergence, too.

    tolerance: the allowed difference in time, in seconds; None: no difference in time is a divergence.
    """
    lag = Fraction(0)
    parted = False
    first: dict[str, Divergence] = {}
    for index, (was, came) in enumerate(zip_longest(expected, found, fillvalue=Happened(NOTHING, None))):
        times = _seconds(was.at), _seconds(came.at)
        if was.words != came.words:
            kind = kind_of(was.words)
            same = kind == kind_of(came.words) != EVENT
            kind = kind if same else EVENT
            first.setdefault(kind, Divergence(index, was.words, came.words, *times, kind))
            parted = True
            if not same:
                break
        elif was.at is not None and came.at is not None:
            off = came.at - (was.at if was.due is None else was.due)
            if not parted:
                lag = max(lag, abs(off))
            if tolerance is not None and abs(off) > tolerance and TIMING not in first:
                difference = f"{was.words} {float(abs(off) * 1_000_000):.3f} us {'later' if off > 0 else 'earlier'}"
                first[TIMING] = Divergence(index, was.words, difference, *times, TIMING)
    ranked = tuple(sorted(first.values(), key=lambda divergence: (divergence.kind == TIMING, divergence.index)))
    earliest = ranked[0] if ranked and ranked[0].kind != TIMING else None
    agreed = len(expected)
    if parted:
        rows = numbered((event.words for event in expected), (event.words for event in found))
        agreed = sum(run.length for run in align(*rows))
    return Comparison(agreed, earliest, lag, ranked)


def _seconds(at: Fraction | None) -> float | None:
    return None if at is None else float(at)


def i2c_words(events: Iterable[i2c.Event], per_second: Fraction, origin: int = 0) -> list[Happened]:
    """Convert I2C events to texts with times.

    per_second: positions per second.
    origin: the position at which the capture begins.
    """
    return [Happened(_i2c(event), (event.at - origin) / per_second) for event in events]


def _i2c(event: i2c.Event) -> str:
    way = "read" if event.read else "write"
    if event.kind is I2cRowKind.ADDRESS:
        return f"address {event.value:02X} {way}"
    if event.kind is I2cRowKind.DATA:
        return f"data {way} {event.value:02X}"
    if event.kind is I2cRowKind.CUT:
        return f"cut off after {event.value:0{event.bits}b}"
    return i2c.NAMES[event.kind]


def byte_words(value: int, frame_error: bool, parity_error: bool) -> str:
    """Format a received word and its errors, for example 55, 00 FE (framing error) or 41 PE (parity error)."""
    return f"{value:02X}{' FE' if frame_error else ''}{' PE' if parity_error else ''}"


@dataclass
class Report:
    """The result of a replay.

    events: number of compared events of the capture.
    agreed: number of these events that are also in the replay, in the same order.
    first_divergence: the earliest divergence that is not of kind TIMING, without its history.
    divergences: the first divergence of each kind, with its history, in the order of the events. In a closed loop, a
        divergence of kind TIMING is last, and makes the replay fail only if the user has given a tolerance. In an open
        loop, a divergence of kind TIMING always makes the replay fail.
    bytes: I2C: number of bytes on the replayed wires, addresses included. UART: number of bytes that the firmware read.
    nacks: number of NACKs on the replayed wires.
    refusals, captured_refusals: closed loop: how often the firmware, and the captured target, refused its address. They
        may differ, since the controller polls until the firmware answers.
    busy_us, captured_busy_us: [lower bound, upper bound] of the time for which the firmware, or the captured target,
        is busy after a write. Of all writes together, the lower bound is the longest time from the STOP to a NACK of
        the address, and the upper bound is the shortest time from the STOP to an ACK after a NACK. Without such an ACK,
        the list is empty. If the busy time differs between writes, the lower bound may be the larger one.
    captured_events, captured_transfers: numbers of events and transfers in the whole capture.
    transfers: number of replayed transfers.
    captured_errors: number of UART frames with a framing or parity error in the capture, without breaks and ambiguous
        frames.
    errors: UART: for FE and PE, the number of words that the firmware read with this flag; for other flags, how often
        the flag was set.
    ambiguous: number of events that are not judged, because receivers may read them in different ways.
    filled: names of the firmware's settings that were taken from the capture.
    unjudged: the reason why the replay proves nothing; "" if there is none.
    tolerance_us: I2C: the allowed difference in time.
    stretch_worst_us, stretch_total_us: the longest and the total time for which the targets hold SCL low. Closed loop:
        counted from the release of SCL by the controller. Open loop: counted from the falling edge of SCL.
    captured_stretch_us: the time by which the longest low phase of SCL in the capture exceeds the usual one; 0 if it
        exceeds this only slightly.
    lag_worst_us: the largest difference in time between an event of the capture and the same event in the replay. For
        UART, it is the largest time from a word's start bit to the firmware's read of the word.
    lag_samples: `lag_worst_us` in sample periods of the capture.
    late_worst_us: open loop: the longest time for which the chip holds SCL low after SCL rises in the capture.
    simulated_s: the duration of the run in seconds of simulated time.
    wall_s: the duration of the run in seconds of real time, without preparation and comparison.
    kernel_events: number of events that the simulation kernel executed.
    """

    case: str
    capture: str
    kind: str  # kind of the replay: i2c, uart, or session (both together)
    verdict: str  # pass, ambiguous, not judged or fail
    events: int
    agreed: int
    first_divergence: Divergence | None
    bytes: int
    captured_events: int = 0
    transfers: int = 0
    captured_transfers: int = 0
    captured_errors: int = 0
    ambiguous: int = 0
    filled: list[str] = field(default_factory=list)
    unjudged: str = ""
    loop: str = "closed"  # closed or open
    role: str = "slave"  # I2C: role of the F28335, slave or master
    divergences: list[Divergence] = field(default_factory=list)
    tolerance_us: float = 0.0
    # I2C: the addresses of the firmware if it is slave; the addresses of the targets if the firmware is master.
    addresses: list[str] = field(default_factory=list)
    nacks: int = 0
    refusals: int = 0
    captured_refusals: int = 0
    busy_us: list[float] = field(default_factory=list)
    captured_busy_us: list[float] = field(default_factory=list)
    errors: dict[str, int] = field(default_factory=dict)
    stretch_worst_us: float = 0.0
    stretch_total_us: float = 0.0
    captured_stretch_us: float = 0.0
    late_worst_us: float = 0.0
    lag_worst_us: float = 0.0
    lag_samples: float = 0.0
    simulated_s: float = 0.0
    wall_s: float = 0.0
    kernel_events: int = 0
    budgets: list[Verdict] = field(default_factory=list)  # verdicts of budgets; only the replay of a session has them
    unknowns: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


PASS, AMBIGUOUS, NOT_JUDGED, FAIL = "pass", "ambiguous", "not judged", "fail"

# For settings that a replay can fill in from the capture: the part of the traffic that the setting determines. If the
# setting is filled in, the headline says that this part comes from the capture.
DECIDES = {"replies": "the data", "asleep": "the refusals", "busy": "the refusals", "script": "the requests"}


def verdict_of(failed: bool, asked: bool, ambiguous: int = 0) -> str:
    """Return the verdict of a replay.

    failed: True if the replay differs from the capture.
    asked: False if a replay without differences proves nothing.
    ambiguous: number of ambiguous events.
    """
    if failed:
        return FAIL
    if not asked:
        return NOT_JUDGED
    return AMBIGUOUS if ambiguous else PASS


def headline(report: Report) -> str:
    """Return the first line of a printed report: the verdict, the replayed part of the capture, and restrictions."""
    parts = [report.verdict.upper()]
    if report.verdict == NOT_JUDGED:
        return f"{parts[0]}: {report.unjudged}"
    if covered := _coverage(report):
        parts.append(f"for {covered}")
    if report.ambiguous:
        parts.append(f"({report.ambiguous} of {report.events} ambiguous)")
    if report.captured_errors:
        parts.append(f"({report.captured_errors} of {report.events} frames have errors in the capture itself)")
    taken = sorted({DECIDES[name] for name in report.filled if name in DECIDES})
    if taken and report.verdict != FAIL:
        return f"{' '.join(parts)}: timing and protocol only; {' and '.join(taken)} came from the capture"
    return " ".join(parts)


def _coverage(report: Report) -> str:
    """Return a phrase with the replayed part of the capture; "" if the whole capture was replayed."""
    if report.captured_events <= report.events or 0 < report.captured_transfers <= report.transfers:
        return ""
    transfers = f", {report.transfers} of {report.captured_transfers} transfers" if report.captured_transfers else ""
    return f"{report.events} of {report.captured_events} events{transfers}"

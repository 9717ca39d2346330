"""Collect the report of a replay for the HTML page: its first divergences, with their waveforms.

Report, Replay --one more run, everything recorded--> windows --> timelines
capture --aligned at the last agreed event--> lanes "capture" ----^       --> CaseReport, one row for each divergence

A divergence is a difference of the replay from the capture. Without divergences, one row has the number of events. In a
session, the budgets have rows, too. Times count from the beginning of the capture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ....core.records import Kind
from ....processor.source_location import SourceLocation
from ....replay.picture import Side
from ....replay.replay import Replay
from ....replay.report import FAIL, FIRST, NOT_JUDGED, PASS, TIMING, Divergence, Report, at_text
from ....scene.case.model import Case
from ....timing.verdict import Verdict, Word
from ....traces.decode import i2c
from ....traces.drawing.capture_lanes import labelled_events
from ..explain.chain import place_of
from ..explain.window import I2C_BUS, Window, WrongByte, windows_of_replay
from .failure import Failure, failure, source_around
from .gather import BudgetReport, CaseReport, commit_of, lanes_of, sysclk
from .timeline import Lane, Lanes, Timeline

# Names of the wires, registers and flags whose lanes the page draws at first; other lanes are drawn on request.
I2C_SHOWN = ("AAS", "SDIR", "RRDY", "XRDY", "SCL", "SDA", "I2CDXR", "I2CDRR")
UART_SHOWN = ("RX", "RXFFST", "RXRDY", "FE")


def replay_report(case: Case, player: Replay, report: Report, changes: Sequence[str] = ()) -> CaseReport:
    """Return the report of a replay that has been run. changes: the "key=value" texts with which the case was read."""
    per_second = player.timebase.per_second
    lead = float(player.timebase.seconds(player.origin - player.scene.start))
    divergences = report.divergences if report.verdict in (FAIL, NOT_JUDGED) else []
    verdicts = [_verdict(divergence, report) for divergence in divergences]
    found = windows_of_replay(
        case, [*verdicts, *report.budgets], player.timebase, player.origin, player.kernel.now, player.repeat
    )
    budgets = [
        _divergence(case, player, divergence, window, report)
        for divergence, window in zip(divergences, found, strict=False)
    ]
    own = {window.verdict.name: window for window in found[len(divergences) :]}
    budgets += [_budget(case, per_second, verdict, own.get(verdict.name)) for verdict in report.budgets]
    if not divergences:
        budgets.insert(0, _whole(report))
    return CaseReport(
        name=f"{case.name}, {Path(report.capture).name}",
        about=f"Replay of a capture, {report.loop} loop. Times count from the beginning of the capture, "
        f"{lead:g} s after the start of the firmware.",
        verdict="pass" if report.verdict == PASS else "fail",
        standing="good" if report.verdict == PASS else "bad",
        simulated_s=report.simulated_s,
        wall_s=report.wall_s,
        clocks=tuple((name, f"{float(sysclk(unit) / 1_000_000):.9g} MHz") for name, unit in case.unit.items()),
        options=tuple(report.unknowns),
        changes=tuple(changes),
        counts={"events as in the capture": report.agreed, "events of the capture": report.events}
        | {"bytes": report.bytes, "NACKs": report.nacks, "address refused": report.refusals},
        findings=(report.unjudged,) if report.verdict == NOT_JUDGED else (),
        notes=tuple(report.notes),
        budgets=tuple(budgets),
        commit=commit_of(case.folder),
    )


def _verdict(divergence: Divergence, report: Report) -> Verdict:
    at = divergence.capture_s if divergence.replay_s is None else divergence.replay_s
    others = report.first_divergence is not None or not all(verdict.passed for verdict in report.budgets)
    unjudged = report.verdict != FAIL or (divergence.kind == TIMING and others)
    word: Word = "not judged" if unjudged else "fail"
    measure = f"event {divergence.index + 1} of {report.events}"
    return Verdict(FIRST[divergence.kind], measure, "count", 1, 0, -1, 1, word, at or 0.0)


def _whole(report: Report) -> BudgetReport:
    """Return the row of a replay without divergences."""
    word: Word = "not judged" if report.verdict == NOT_JUDGED else "pass"
    why = report.unjudged if report.verdict == NOT_JUDGED else ""
    margin = report.agreed - report.events
    verdict = Verdict(
        "events as in the capture",
        f"{report.loop} loop",
        "count",
        report.agreed,
        report.events,
        margin,
        report.events,
        word,
        None,
        which="exactly",
        found=why,
    )
    return BudgetReport(verdict, (), "", False, None, None, None, Failure(why) if why else None)


def _budget(case: Case, per_second: int, verdict: Verdict, window: Window | None) -> BudgetReport:
    """Return the report of a budget. Only the replay of a session (I2C and UART together) judges budgets."""
    timeline = None if window is None else lanes_of(case, window).timeline()
    wrong = failure(verdict, False, None, None, per_second)
    limits = ((verdict.which, f"{verdict.limit}"),)
    return BudgetReport(verdict, limits, "", False, None, timeline, None, wrong, per_second=per_second)


def _divergence(case: Case, player: Replay, divergence: Divergence, window: Window, report: Report) -> BudgetReport:
    per_second = player.timebase.per_second
    shown = UART_SHOWN if report.kind == "uart" else I2C_SHOWN
    window = replace(window, chain_texts=(" ".join(shown),), expected=_expected(divergence, window))
    captured, replayed, _ = player.sides(divergence)
    lanes = lanes_of(case, window)
    timeline = lanes.timeline()
    if report.kind != "uart":
        timeline = _with_capture(timeline, lanes, player.origin + replayed.agreed * per_second, captured, divergence)
    why = f"{divergence.cause[:1].upper()}{divergence.cause[1:]}" if divergence.cause else ""
    place = _place(divergence, window)
    source = place_of(place) if place is not None else None
    return BudgetReport(
        verdict=window.verdict,
        limits=(("expected", f"{divergence.expected} {at_text(divergence.capture_s)}"),),
        source="",
        must_break=False,
        distribution=None,
        timeline=timeline,
        explanation=None,
        failure=Failure(
            f"expected {divergence.expected} {at_text(divergence.capture_s)} of the capture, "
            f"found {divergence.found} {at_text(divergence.replay_s)} of the replay",
            why=why,
            source=None if source is None else source_around(source),
        ),
        per_second=per_second,
    )


def _place(divergence: Divergence, window: Window) -> SourceLocation | None:
    """Return the location in the firmware that the cause of a divergence names, if it was recorded."""
    spot = divergence.cause.rpartition(" at ")[2].partition(",")[0]
    places = (record.text for record in reversed(window.all_records) if record.kind in (Kind.ACCESS, Kind.WAIT))
    own = (place for place in places if isinstance(place, SourceLocation))
    return next((place for place in own if f"{Path(place.path).name}:{place.line}" == spot), None)


def _expected(divergence: Divergence, window: Window) -> dict[WrongByte, int]:
    """Return the wrong byte of a divergence with its expected value; {} if the firmware did not send a wrong byte."""
    if not divergence.expected.startswith("data read "):
        return {}
    for transfer in i2c.transfers(window.edges):
        for phase in transfer.phases:
            for place, byte in enumerate(phase.bytes[1:]):
                if abs(byte.at - window.begin) <= 1:
                    return {(I2C_BUS, phase.start.at, place): int(divergence.expected.split()[-1], 16)}
    return {}


def _with_capture(timeline: Timeline, lanes: Lanes, agreed: float, side: Side, divergence: Divergence) -> Timeline:
    """Return the timeline with additional lanes: the waveforms and the bytes of the capture.

    lanes: the builder of the timeline.
    agreed: the time of the last event that is equal in capture and replay, as a tick of the replay.
    """
    first, end = lanes.window.kept[0].begin, lanes.window.kept[-1].end

    def tick(seconds: float) -> int:
        return round(agreed + seconds * timeline.per_second)

    captured = []
    for name, channel in side.lines:
        lane = Lane("wave", f"captured {name}", initial=channel.initial, chosen=True)
        for position, level in zip(channel.edges.tolist(), channel.levels.tolist(), strict=True):
            at = tick(side.seconds(position))
            if at < first:
                lane.initial = level
            elif at < end:
                lanes.add(lane, at, f"{name} {'rises' if level else 'falls'} in the capture")
        captured.append(lane)
    boxes = Lane("boxes", "captured bytes", chosen=True)
    for transfer in side.transfers:
        for event, label, _, _ in labelled_events(transfer):
            at = tick(side.of_transfer(event.at))
            if event.value >= 0 and first <= at < end:
                wrong = (
                    divergence.capture_s is not None
                    and abs(side.of_transfer(event.at) + side.agreed - divergence.capture_s) < 1e-9
                )
                says = f"{i2c.NAMES[event.kind]} {label} in the capture"
                lanes.add(boxes, at, says, label, tick(side.of_transfer(event.last)), int(wrong))
    bus, *rest = timeline.groups
    return replace(timeline, groups=(bus, ("capture", (*captured, boxes)), *rest))

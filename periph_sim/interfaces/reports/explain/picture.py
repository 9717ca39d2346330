"""A window as a small timing diagram, in characters or SVG.

    wires: SCL, SDA, bytes, pins that change
    flags: fields that are related to the measure, or that the measure or the explanation names
    firmware of each unit: service routines, spans, waits

Time 0 of the axis is the instant of the verdict, as in tables.
"""

from __future__ import annotations

import re
from itertools import groupby, pairwise

from ....core.records import Kind
from ....records.register_maps import register_of
from ....timing.verdict import in_words, instant
from ....traces.capture.capture import Span
from ....traces.drawing.capture_lanes import wire_lanes
from ....traces.drawing.svg_diagram import BLACK, BLUE, GREY, ORANGE, Box, Lane, Mark, timing_diagram
from ....traces.drawing.text_diagram import text_diagram
from .characters import characters
from .cpu_activity import Stretch, episodes, timeline, units
from .occurrence import event_of
from .window import Window

ANSWER = ("I2CSTR.AAS", "I2CSTR.SDIR", "I2CSTR.XRDY")
RECEIVED = ("SCIFFRX.RXFFINT",)
# A dictionary from the last event of a measure to the flags that are related to this event.
FLAGS: dict[str, tuple[str, ...]] = {
    "answer": ANSWER,
    "stretch": ANSWER,
    "wrong bytes": (*ANSWER, "I2CDXR.DATA"),
    "refused": ANSWER[:1],
    "age": RECEIVED,
    "model age": RECEIVED,
    "words": RECEIVED,
    "lost": RECEIVED,
}
COLUMNS_SVG = 160  # number of columns into which an SVG is divided to decide which bytes and bits are drawn
LEAST_BOX = 400  # the box of a service routine, span or wait is at least 1/LEAST_BOX as wide as the picture


def text_picture(window: Window, width: int) -> list[str]:
    """Return the lines of the diagram, at most `width` characters long; no lines if there is nothing to draw."""
    lanes = _lanes(window, width)
    if not lanes:
        return []
    return text_diagram(lanes, _span(window), _marks(window), f"from {instant(window.verdict.at_s)} on", width)


def svg_picture(window: Window) -> str:
    """Return the diagram as SVG text. It has one empty lane if there is nothing to draw."""
    lanes = _lanes(window, COLUMNS_SVG) or [Lane("nothing", "", GREY)]
    verdict = window.verdict
    title = f"{verdict.name}: worst{'' if verdict.worst is None else ' ' + _figure(window)} at {instant(verdict.at_s)}"
    return timing_diagram(lanes, _span(window), _marks(window), title, f"from {instant(verdict.at_s)} on")


def _lanes(window: Window, columns: int) -> list[Lane]:
    of_characters = _characters(window, columns)
    lanes = []
    expected = window.expected_on_bus
    for lane in wire_lanes(window.edges, window.drawn, lambda at: _seconds(window, at), columns, expected=expected):
        lanes += [lane, *of_characters.get(lane.name, ())]
    lanes += [_flag_lane(window, where, what) for where, what in flags_shown(window)]
    there = units(window)
    for unit in there:
        lanes += _firmware(window, unit, unit if len(there) > 1 else "firmware")
    return lanes


def _characters(window: Window, columns: int) -> dict[str, list[Lane]]:
    """Return the lanes of each serial line: its characters, and their bits if a bit is at least three columns wide.

    If a bit is narrower than a column, a character is one box, without boxes for its start and stop bits. If a
    character is narrower than four columns, there is no lane.
    """
    begin, end = window.drawn
    column = (end - begin) / columns
    found: dict[str, list[Lane]] = {}
    shown = sorted(one for one in characters(window) if one.end > begin and one.begin < end)
    for wire, several in groupby(shown, key=lambda one: one.wire):
        of = list(several)
        if min(one.end - one.begin for one in of) < 4 * column:
            continue
        bit = min((b - a for one in of for a, b, _ in one.bits), default=0)
        whole, bits = [], []
        for one in of:
            for a, b, text in one.parts() if bit >= column else [(one.begin, one.end, one.text)]:
                wrong = text == one.text and (one.expected is not None or one.error)
                whole.append(Box(_seconds(window, a), _seconds(window, b), text, wrong))
            bits += [Box(_seconds(window, a), _seconds(window, b), text) for a, b, text in one.bits]
        found[wire] = [Lane(f"{wire} bytes", "wires", BLACK, boxes=tuple(whole))]
        if bits and bit >= 3 * column:
            found[wire].append(Lane(f"{wire} bits", "wires", BLACK, boxes=tuple(bits)))
    return found


def _firmware(window: Window, unit: str, group: str) -> list[Lane]:
    """Return up to three lanes: one with service routines, one with spans and one with waits."""
    of = episodes(window, unit, window.drawn.begin, window.drawn.end)
    lanes = []
    for doing, name, colour in (("interrupt", "irq", ORANGE), ("span", "span", BLUE), ("wait", "wait", GREY)):
        alike = timeline(window, unit, *window.drawn, (Kind.SPAN,)) if doing == "span" else of
        boxes = tuple(_box(window, one) for one in alike if one.doing == doing)
        if boxes:
            lanes.append(Lane(name, group, colour, boxes=boxes))
    return lanes


def _box(window: Window, one: Stretch) -> Box:
    drawn = window.drawn
    begin, end = max(one.begin, drawn.begin), min(one.end, drawn.end)
    least = (drawn.end - drawn.begin) // LEAST_BOX
    text = str(one).removeprefix("wait for ").rpartition("I2CSTR.")[2] if one.doing == "wait" else one.what
    return Box(_seconds(window, begin), _seconds(window, max(end, begin + least)), text)


def flags_shown(window: Window) -> list[tuple[str, str]]:
    """Return the module and the name of each field that is shown.

    All fields that the explanation names are shown. A field that the measure names, or that is related to its event, is
    shown if it changes within the picture. A module is written as UNIT.MODULE.
    """
    changed = {(r.where, r.what) for r in window.between(*window.drawn, Kind.FLAG)}
    known = {(r.where, r.what) for r in window.all_records if r.kind is Kind.FLAG}
    changed |= {(where, what) for where, what in known if _is_named(window, where, what)}
    measure, event = window.verdict.measure, event_of(window.verdict)
    about = () if event is None else FLAGS.get(event.how, ())
    order = {what: i for i, what in enumerate(about)}
    chosen = [
        (where, what)
        for where, what in changed
        if what in about or f"{where.partition('.')[2]}.{what}" in measure or _is_named(window, where, what)
    ]
    return sorted(chosen, key=lambda one: (one[0], order.get(one[1], 0), one[1]))


def _is_named(window: Window, where: str, what: str) -> bool:
    """Return True if the explanation names a field, or the register if the register consists of this field alone."""
    name = _shown(where, what)
    return any(re.search(rf"\b{name}\b(?!\.)", text) for text in window.chain_texts)


def _shown(where: str, what: str) -> str:
    """Format a field as "I2CSTR.SDIR", or as the register, "I2COAR", if the register consists of this field alone."""
    name, _, _ = what.partition(".")
    register = register_of(where.partition(".")[2], name)
    return name if register is not None and len(register.fields) == 1 else what


def _flag_lane(window: Window, where: str, what: str) -> Lane:
    """Return the lane of a field: a wave for a flag, or boxes with the values for a field of several bits."""
    changes = [r for r in window.all_records if (r.kind, r.where, r.what) == (Kind.FLAG, where, what)]
    earlier = [r for r in changes if r.tick < window.drawn.begin]
    inside = [r for r in changes if window.drawn.begin <= r.tick < window.drawn.end]
    register, name = what.partition(".")[0], _shown(where, what).rpartition(".")[2]
    if name != register and all(r.value in (0, 1) for r in changes):
        # Before its first recorded change, a flag has the opposite of the level after the change. The first change may
        # be later than the picture.
        initial = earlier[-1].value if earlier else 1 - changes[0].value
        edges = tuple((_seconds(window, r.tick), r.value) for r in inside)
        return Lane(name, "flags", BLACK, initial=initial, edges=edges)
    marks = [*((window.drawn.begin, r.value) for r in earlier[-1:]), *((r.tick, r.value) for r in inside)]
    boxes = tuple(
        Box(_seconds(window, tick), _seconds(window, end), f"0x{value:02X}" if value > 9 else f"{value}")
        for (tick, value), (end, _) in pairwise([*marks, (window.drawn.end, 0)])
    )
    return Lane(name, "flags", BLACK, boxes=boxes)


def _marks(window: Window) -> list[Mark]:
    name = window.verdict.name
    if window.begin == window.end:
        return [Mark(_seconds(window, window.begin), name)]
    length = (window.end - window.begin) * 1_000_000 / window.timebase.per_second
    later = _figure(window) if window.verdict.until_s is None else in_words(length, "us")
    return [
        Mark(_seconds(window, window.begin), f"{name}: worst begins"),
        Mark(_seconds(window, window.end), f"ends, {later} later"),
    ]


def _span(window: Window) -> tuple[float, float]:
    return _seconds(window, window.drawn.begin), _seconds(window, window.drawn.end)


def _seconds(window: Window, tick: float) -> float:
    return (tick - window.at) / window.timebase.per_second


def _figure(window: Window) -> str:
    return in_words(window.verdict.worst or 0, window.verdict.unit)


def within_reach(window: Window, most: int) -> tuple[Span, ...]:
    """Return the recorded ranges, shortened so that they contain about `most` records, if they contain more.

    The records nearest to the occurrence are kept. If the occurrence alone has too many records, its first ones are
    kept.
    """
    if len(window.records) <= most:
        return window.kept
    inside = [r.tick for r in window.records if window.begin <= r.tick <= window.end]
    if len(inside) >= most:
        return (Span(min(window.drawn.begin, window.begin), inside[most - 1] + 1),)
    reach = sorted(max(window.begin - r.tick, r.tick - window.end, 0) for r in window.records)[most - 1]
    first, last = window.begin - reach, window.end + reach
    cut = [Span(max(span.begin, first), min(span.end, last + 1)) for span in window.kept]
    return tuple(span for span in cut if span.begin < span.end)

"""A Chain as lines of text, and as JSON: plain numbers in microseconds and cycles.

stretch 97.953 us, at most 50.000 us allowed, at 0.105195 s
    -190.000 us              repeated START, gyroscope (0x68 R)
    -102.680 us  200.387 us  SCIRXINTA entered, preempting the wait for ... [imu_hil.py:60 (sci_received)]
  made up of
    97.560 us  99.6 %  span frame [imu_hil.py:66 (sci_received)]
  +97.953 us against 0.000 us, its least critical occurrence
    +97.560 us  span frame
"""

from __future__ import annotations

from pathlib import Path

from ....core.text_table import columns, together
from ....timing.verdict import Verdict, in_words, instant, percentile
from .chain import Chain, FirmwarePlace, Part

MOST_PARTS = 6


def text(chain: Chain) -> list[str]:
    """Return the lines; the first one has the budget, its figure and the instant."""
    lines = [_head(chain.verdict)]
    rows = []
    for step in chain.steps:
        length = "" if step.length is None else _us(chain, step.length)
        rows.append((_us(chain, step.at), length, f"{step.what}{_bracketed(step.place)}"))
    lines += _table(rows) if rows else []
    if chain.parts:
        rows = [
            (_us(chain, part.length), f"{100 * part.length / chain.length:.1f} %", _counted(part))
            for part in _largest(chain.parts)
        ]
        lines += ["  made up of", *_table(rows)]
    if chain.more:
        more = _us(chain, chain.length - (chain.typical or 0), sign=True)
        rows = [(_us(chain, part.length, sign=True), "", str(part)) for part in _largest(chain.more)]
        lines += [f"  {more} against {_us(chain, chain.typical or 0)}, its least critical occurrence", *_table(rows)]
    return lines


def _head(verdict: Verdict) -> str:
    kept = verdict.margin is not None and verdict.margin >= 0
    if verdict.worst is None or (verdict.broken and kept):
        return f"{verdict.name}: {verdict.found or 'nothing was measured'}"
    return f"{verdict.name} {in_words(verdict.worst, verdict.unit)}, {_limit(verdict)}, at {instant(verdict.at_s)}"


def _limit(verdict: Verdict) -> str:
    which = {"max": "at most", "min": "at least", "exactly": "exactly"}.get(verdict.which)
    which = which or f"{percentile(verdict.which)} at most"
    return f"{which} {in_words(verdict.limit, verdict.unit)} allowed"


def _us(chain: Chain, ticks: int, sign: bool = False) -> str:
    value = chain.us(ticks)
    plus = "+" if sign and ticks > 0 else ""
    return f"{plus}{float(value):.3f} us" if abs(value) < 10_000 else f"{plus}{float(value / 1000):.3f} ms"


def _largest(parts: tuple[Part, ...]) -> tuple[Part, ...]:
    return tuple(sorted(parts, key=lambda part: -abs(part.length))[:MOST_PARTS])


def _counted(part: Part) -> str:
    return f"{part}{f', {part.count} times' if part.count > 1 else ''}{_bracketed(part.place)}"


def _bracketed(place: FirmwarePlace | None) -> str:
    """Format a place in brackets after a blank, not to be broken into lines."""
    return "" if place is None else f" {together(f'[{place}]')}"


def _table(rows: list[tuple[str, str, str]]) -> list[str]:
    return columns(rows, right=(0, 1), indent="    ")


def as_json(chain: Chain) -> dict[str, object]:
    """Convert to JSON, in us. steps: at, what, length, file, line, function; parts: what, length, count, place."""
    return {
        "steps": [
            {"at_us": _number(chain, step.at), "what": step.what}
            | ({} if step.length is None else {"length_us": _number(chain, step.length)})
            | _place(step.place)
            for step in chain.steps
        ],
        "parts": [_json_part(chain, part) for part in chain.parts],
        "length_us": _number(chain, chain.length),
        "typical_us": None if chain.typical is None else _number(chain, chain.typical),
        "more": [_json_part(chain, part) for part in chain.more],
    }


def _json_part(chain: Chain, part: Part) -> dict[str, object]:
    row = {"what": str(part), "length_us": _number(chain, part.length), "count": part.count}
    return row | _place(part.place)


def _place(place: FirmwarePlace | None) -> dict[str, object]:
    if place is None:
        return {}
    file = {} if place.file is None else {"file": relative(place.file).as_posix()}
    pc = {} if place.pc is None else {"pc": f"{place.pc:#08x}"}
    return {"function": place.function, "line": place.line} | file | pc


def relative(file: Path) -> Path:
    """Return the path relative to the current directory, if it is below that."""
    try:
        return file.relative_to(Path.cwd())
    except ValueError:
        return file


def _number(chain: Chain, ticks: int) -> float:
    return round(float(chain.us(ticks)), 4)

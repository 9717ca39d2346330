"""A trade for people and for programs: a `Trade` goes in; tables of 80 columns, or what `--json` prints, come out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from math import inf, isinf

from ...core.text_table import paragraph, text_table, together
from ...timing.format_value import duration_text
from .cost import TRACED
from .errors import CYCLES, Errors
from .levels import REFERENCE
from .trade import LONGER, Outcome, Trade

INFINITE = "infinite"
MEMORY = f"most that Python had allocated in the first {duration_text(float(TRACED))} (tracemalloc)"


def text(found: Trade) -> str:
    """What each level costs and how far it is off; then, level by level, each observable that is not exact."""
    return "\n".join(_lines(found))


def _lines(found: Trade) -> Iterator[str]:
    part = "" if found.simulated_s >= found.duration_s else f" the first {duration_text(found.simulated_s)} of"
    yield from paragraph(
        f"{found.case}:{part} {duration_text(found.duration_s)}, {found.observables} observables, {found.occurrences} "
        f"occurrences; against {REFERENCE}, in SYSCLKOUT cycles of {found.cycle_s * 1e9:.3f} ns"
    )
    if found.unmeasured:
        yield from paragraph(f"unmeasured, since they do not occur in it: {', '.join(found.unmeasured)}")
    cost = found.reference.cost
    if cost is not None and not cost.i2c_bytes and not cost.sci_bytes:
        yield from paragraph(f"no bus carries a byte in it, so errors in bytes are not known; {LONGER}")
    yield ""
    yield from _costs(found)
    yield "CPU: seconds of processor time a simulated second, without records"
    yield from paragraph(f"memory: {MEMORY}")
    for outcome in found.outcomes[1:]:
        yield ""
        yield from _level(outcome, found)


def _costs(found: Trade) -> list[str]:
    rows = [_row(outcome, outcome is found.reference) for outcome in found.outcomes]
    return text_table(("level", "CPU", "I2C bytes/s", "events/byte", "memory", "worst error"), rows, range(1, 6))


def _row(outcome: Outcome, is_reference: bool) -> tuple[str, ...]:
    cost = outcome.cost
    if cost is None:
        return (outcome.level.name, "-", "-", "-", "-", "refused")
    worst = "reference" if is_reference else _worst(outcome)
    speed = f"{cost.bytes_per_cpu_second:.0f}" if cost.i2c_bytes else "-"
    events = f"{cost.events_per_byte:.1f}" if cost.events_per_byte else "-"
    memory = f"{cost.memory / 1e6:.2f} MB"
    return (outcome.level.name, f"{cost.cpu_per_second:.3g} s", speed, events, memory, worst)


def _worst(outcome: Outcome) -> str:
    """In cycles; what is no time has an error of its own."""
    others = any(each.worst for each in outcome.errors if each.unit != CYCLES)
    if not outcome.worst:
        return "values" if others else "exact"
    return number(outcome.worst)


def _level(outcome: Outcome, found: Trade) -> Iterator[str]:
    name, cost = outcome.level.name, outcome.cost
    if cost is None:
        yield from paragraph(f"{name}: refused: {outcome.refused}")
        return
    measured = [each for each in outcome.errors if each.measured]
    wrong = [each for each in measured if not each.exact]
    share = f"; {cost.share}" if cost.share else ""
    if not wrong:
        yield from paragraph(f"{name}: all {len(measured)} observables exact{share}")
        return
    yield from paragraph(f"{name}: {len(measured) - len(wrong)} of {len(measured)} observables exact{share}")
    yield ""
    rows = [
        (each.name, f"{each.count}", number(each.mean), number(each.p99), number(each.worst), together(each.unit))
        for each in sorted(wrong, key=lambda each: -each.worst)
    ]
    yield from text_table(("observable", "count", "mean", "p99", "worst", ""), rows, range(1, 5))
    for each in wrong:
        if isinf(each.worst):
            yield from paragraph(f"{each.name}: {without_partner(each)}")


def without_partner(each: Errors) -> str:
    """`lacks 2, adds 1, 3 in another order`: why an error is infinite."""
    told = [f"lacks {each.lacking}"] * bool(each.lacking) + [f"adds {each.added}"] * bool(each.added)
    return ", ".join(told + [f"{each.disordered} in another order"] * bool(each.disordered))


def number(value: float) -> str:
    """`infinite`, `0`, `13`, `3.75`, `93686.2`: no more digits than tell something."""
    if isinf(value):
        return INFINITE
    digits = f"{value:.1f}" if value >= 100 else f"{value:.3g}"
    return digits.rstrip("0").rstrip(".") if "." in digits and "e" not in digits else digits


def as_json(found: Trade) -> dict[str, object]:
    """Infinite errors are the text "infinite"; of what is unmeasured they are null."""
    return {
        "case": found.case,
        "simulated_s": found.simulated_s,
        "cycle_s": found.cycle_s,
        "unmeasured": list(found.unmeasured),
        "memory": MEMORY,
        "levels": [_outcome_as_json(outcome) for outcome in found.outcomes],
    }


def _outcome_as_json(outcome: Outcome) -> dict[str, object]:
    cost = outcome.cost
    told: dict[str, object] = {"name": outcome.level.name, "changes": list(outcome.level.changes)}
    if cost is None:
        return told | {"refused": outcome.refused}
    costs = {
        "cpu_s_per_simulated_s": cost.cpu_per_second,
        "i2c_bytes_per_cpu_s": cost.bytes_per_cpu_second,
        "events_per_byte": cost.events_per_byte,
        "events": cost.events,
        "memory_bytes": cost.memory,
        "byte_level_bytes": cost.byte_level,
        "sci_frames": cost.sci_frames,
        "sci_frames_at_byte_level": cost.sci_frames_passed,
    }
    return told | {
        "cost": costs,
        "worst_cycles": _finite(outcome.worst),
        "observables": [_errors_as_json(each) for each in outcome.errors],
    }


def _errors_as_json(errors: Errors) -> dict[str, object]:
    shown = {key: _finite(value) if isinstance(value, float) else value for key, value in asdict(errors).items()}
    return shown if errors.measured else shown | dict.fromkeys(("mean", "p99", "worst"))


def _finite(value: float) -> float | str:
    return INFINITE if value == inf else value

"""A profile for people and for programs: time by function goes in; a table, or one dictionary, comes out."""

from __future__ import annotations

from collections.abc import Mapping

from ...core.text_table import paragraph, text_table
from ...processor.image.profile import Profile

LONGEST_TEXT = 20  # functions that the text shows unless all are asked for


def text(profiles: Mapping[str, Profile], ticks_per_second: int, every: bool = False) -> str:
    """A table of 80 columns for each unit. every: all functions that were called."""
    lines: list[str] = []
    for unit, profile in profiles.items():
        found = profile.functions()
        whole = sum(one.own for one in found) or 1
        shown = found if every else found[:LONGEST_TEXT]
        per_us = ticks_per_second / 1_000_000
        rows = [
            (
                one.name,
                f"{one.own / per_us:.3f}",
                f"{100 * one.own / whole:.1f}",
                f"{one.total / per_us:.3f}",
                f"{one.waits / per_us:.3f}",
                str(one.calls),
            )
            for one in shown
        ]
        lines += [f"{unit}: {whole / per_us:.3f} us in {len(found)} functions", ""]
        lines += text_table(("function", "self us", "%", "total us", "waits us", "calls"), rows, right=(1, 2, 3, 4, 5))
        if len(found) > len(shown):
            lines.append(f"and {len(found) - len(shown)} with less; -v lists them all")
        lines.append("")
    note = "self: in its own code, waits included; total: with what it called, and with interrupts in between"
    return "\n".join([*lines, *paragraph(note), *paragraph("waits: asleep in IDLE, or in polls that were skipped")])


def as_json(profiles: Mapping[str, Profile], ticks_per_second: int) -> dict[str, object]:
    """The same as one dictionary; times in seconds."""
    return {
        "units": {
            unit: [
                {
                    "function": one.name,
                    "calls": one.calls,
                    "self_s": one.own / ticks_per_second,
                    "total_s": one.total / ticks_per_second,
                    "waits_s": one.waits / ticks_per_second,
                }
                for one in profile.functions()
            ]
            for unit, profile in profiles.items()
        }
    }

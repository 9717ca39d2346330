"""Findings of the lints as text and as JSON."""

from __future__ import annotations

from .lint_finding import Finding
from .lint_runner import all_lints
from .run import Run


def text(run: Run, findings: list[Finding]) -> str:
    """Return the findings as text, each with its place, source, lint and first time; then their number."""
    lines = []
    for f in findings:
        times = "once" if f.count == 1 else f"{f.count} times, first"
        lines.append(f"{f.unit} {f.place}: {f.text} [{f.source}]")
        lines.append(f"  {f.lint}, {times} at {run.at(f.first)}")
    places = f"{len(findings)} finding{'s' * (len(findings) != 1)}" if findings else "nothing found"
    return "\n".join([*lines, f"{run.name}: {places} by {len(all_lints())} lints"])


def as_json(run: Run, findings: list[Finding]) -> dict[str, object]:
    """Return the findings for JSON, with times in seconds."""
    return {
        "run": run.name,
        "lints": {name: one.SAYS for name, one in all_lints().items()},
        "findings": [
            {
                "lint": f.lint,
                "unit": f.unit,
                "place": f.place,
                "count": f.count,
                "first_s": float(run.seconds(f.first)),
                "text": f.text,
                "source": f.source,
            }
            for f in findings
        ],
    }

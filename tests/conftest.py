"""What all tests share: timing diagrams that differ are shown one above the other; no test has a deadline."""

from __future__ import annotations

from hypothesis import settings

from tests.waves import Diagram

settings.register_profile("periph-sim", deadline=None)  # seconds are no property: machines are shared
settings.load_profile("periph-sim")


def pytest_assertrepr_compare(op: str, left: object, right: object) -> list[str] | None:
    if op != "==" or not (isinstance(left, Diagram) and isinstance(right, Diagram)):
        return None
    lines = ["the timing diagram came out otherwise:"]
    for came, wanted in zip(left.splitlines(), right.splitlines(), strict=False):
        lines.append(f"  came    {came}")
        if came != wanted:
            lines.append(f"  wanted  {wanted}")
            lines.append("          " + "".join(" ^"[a != b] for a, b in zip(came, wanted, strict=False)))
    return lines

"""The view in the terminal: the contents of the screen at any size."""

from __future__ import annotations

from io import StringIO

import pytest
from rich.console import Console

from periph_sim.interfaces.commands.live_view import screen
from tests.outside.live.view.imu import FRAME, Imu

BUDGETS = [
    *({"name": f"round {n}", "measure": "round", "max": "3 ms"} for n in range(8)),
    {"name": "too much", "measure": "round", "max": "1 us"},
]


def lines(height: int, **more: object) -> list[str]:
    imu = Imu(budget=BUDGETS)
    imu.line.write(FRAME)
    for _ in range(3):
        imu.passes("20 ms")
        imu.status.snapshot()
    imu.line.write(FRAME)
    imu.status.say("client 1 came")
    out = StringIO()
    console = Console(file=out, width=80, height=height, color_system=None)
    console.print(screen({**imu.status.snapshot(), **more}, height))
    return [line.rstrip() for line in out.getvalue().splitlines()]


def test_a_large_screen_shows_everything() -> None:
    shown = "\n".join(lines(60))
    for part in (
        "mine: live, 0.1 s simulated, 0.50 s a second",
        "SCI bytes in, ",
        "a simulated second; 12 wait",
        "attitude      roll ",
        "flags     none",
        "lateness  99 % within 100 ms, worst 60 ms; over 50 ms: 1 (catch-up)",
        "          client 1 came",
        "budget so far",
    ):
        assert part in shown, part
    assert all(len(line) <= 80 for line in lines(60))
    assert lines(60, over=True)[0].startswith("mine: ended at 0.1 s simulated")


@pytest.mark.parametrize("height", [18, 24])
def test_on_a_small_screen_broken_budgets_come_first(height: int) -> None:
    shown = lines(height)
    assert len(shown) < height
    place = next(n for n, line in enumerate(shown) if line.startswith("budget so far ("))
    assert shown[place + 1].startswith("too much")

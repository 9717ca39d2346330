"""The view of a live session in the terminal, updated in place from the snapshots on the session's board.

The board holds the latest snapshot of the session. A separate thread prints it, so that the simulation never waits for
the terminal.
"""

from __future__ import annotations

import sys
import threading

from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.table import Table
from rich.text import Text

from ...outside.live.pacing import in_ms
from ...outside.live.view.status import Board, BudgetSoFar, Lateness, StatusSnapshot

BAR = 30  # number of columns of the longest bar in the chart of lateness
TURNS = 0.0005  # in seconds; after this time, Python interrupts the printing thread to run the thread of the session


def start_view(board: Board) -> threading.Thread:
    """Start and return a thread that prints the snapshots of a board in the terminal, in place, up to the last one."""
    console = Console()

    def run() -> None:
        with Live(console=console, auto_refresh=False) as live:
            for snapshot in board.snapshots():
                if snapshot is not None:
                    live.update(screen(snapshot, console.height), refresh=True)

    sys.setswitchinterval(TURNS)
    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    return thread


def screen(status: StatusSnapshot, height: int = 100) -> RenderableType:
    """Return the content of the screen. height: its number of lines; budgets that do not fit are left out."""
    rates = status["rates"]
    pace = f", {rates['pace']:.2f} s a second" if "pace" in rates else ""
    over = "ended at" if status["over"] else ""
    head = Text(f"{status['case']}: {over or 'live,'} {status['simulated_s']:.1f} s simulated{pace}", style="bold")
    parts: list[RenderableType] = [head, _rates(status), *_readings(status)]
    parts.append(Text(f"flags     {', '.join(status['flags']) or 'none'}"))
    if status["lateness"] is not None:
        parts += _late(status["lateness"])
    parts += [Text(f"          {sentence}") for sentence in status["said"]]
    left = height - len(parts) - 3
    budgets = sorted(status["budgets"], key=lambda one: one["state"] != "fail")
    if budgets and left > 1:
        parts.append(_budgets(budgets[: left - 1], len(budgets)))
    return Group(*parts)


def _rates(status: StatusSnapshot) -> Text:
    parts = [
        f"{rate:.0f} {name}" for name, rate in status["rates"].items() if name != "pace" and status["totals"][name]
    ]
    waiting = status["totals"]["waiting"]
    return Text(
        f"rates     {', '.join(parts) or 'nothing yet'} a simulated second" + (f"; {waiting} wait" if waiting else "")
    )


def _readings(status: StatusSnapshot) -> list[Text]:
    lines = [
        Text(f"{one['chip']:<14}" + "".join(f"{value:>10.3f}" for value in one["values"]) + f"  {one['unit']}")
        for one in status["readings"]
    ]
    if status["attitude"] is not None:
        roll, pitch, yaw = status["attitude"]
        lines.append(Text(f"attitude      roll {roll:7.1f}  pitch {pitch:6.1f}  yaw {yaw:7.1f}  deg"))
    return lines


def _late(late: Lateness) -> list[Text]:
    most = max(late["counts"])
    lines = [Text(f"lateness  99 % within {in_ms(late['p99'])}, worst {in_ms(late['worst'])}; over "
                  f"{in_ms(late['tolerated'])}: {late['late']} ({late['when_late']})")]  # fmt: skip
    ends = [*(f"up to {in_ms(step)}" for step in late["steps"]), f"over {in_ms(late['steps'][-1])}"]
    for end, count, step in zip(ends, late["counts"], [*late["steps"], float("inf")], strict=True):
        if count:
            style = "red" if step > late["tolerated"] else ""
            lines.append(Text(f"  {end:<14}{'█' * max(1, BAR * count // most):<{BAR}}{count:>8}", style=style))
    return lines


def _budgets(budgets: list[BudgetSoFar], count: int) -> Table:
    table = Table(box=None, pad_edge=False, header_style="")
    table.add_column("budget so far" + (f" ({len(budgets)} of {count})" if len(budgets) < count else ""))
    for title in ("seen", "limit", "margin"):
        table.add_column(title, justify="right")
    for one in budgets:
        table.add_row(
            one["name"], one["seen"], one["limit"], one["margin"], style="red" if one["state"] == "fail" else ""
        )
    return table

"""The table of docs/any_order.md on the highest rate of SCL, measured again: `refreshed_limits` rewrites a page.

The case runs twice at each rate: with the most frequent code costs, and with the highest that were found.
"""

from __future__ import annotations

import re
from fractions import Fraction

from periph_sim.core.table import frequency
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from tests.docs.pages import ROOT

CASE = ROOT / "timing" / "imu_any_order.toml"
RATES = ("100 kHz", "200 kHz", "300 kHz", "400 kHz", "500 kHz", "600 kHz", "700 kHz", "800 kHz")
USUAL: tuple[str, ...] = ()
HIGHEST = tuple(
    f"unit.dsp.code.{key}={cycles}"
    for key, cycles in (("between_accesses", 15), ("isr_prologue", 22), ("isr_epilogue", 18))
)
WITHOUT_PAUSES = ('controller.period="6 ms"', 'controller.jitter="1 ms"', 'controller.gap="20 us"')
SECONDS = Fraction(60, 1000)
SET_UP = ((100_000, 0.25), (400_000, 0.1), (1_000_000, 0.05))  # us up to a rate: UM10204 Table 10, tSU;DAT
HEAD = (
    "| SCL | edge read after | SCL held, a byte | SDA set up | verdict | after | held | set up | verdict |\n"
    "|---|---|---|---|---|---|---|---|---|\n"
)
TABLE = re.compile(rf"{re.escape(HEAD)}((?:\|.*\n)*)")


def figures(rate: str, code: tuple[str, ...]) -> list[str]:
    """Return worst latency of the edge routine, longest hold of SCL by the slave, least set-up of SDA, and verdict."""
    result = Scene(load(CASE, [f'controller.rate="{rate}"', *WITHOUT_PAUSES, *code])).run(SECONDS)
    found = {budget.name: budget.worst for budget in result.budgets}
    refused, wrong, stuck = (found[name] for name in ("nacked requests", "wrong bytes", "bus stuck"))
    latency, held, set_up = (found[name] for name in ("edge latency", "stretch", "data set-up"))
    if stuck:
        verdict = "stuck"
    elif refused:
        verdict = "refused"
    elif wrong or wrong is None:
        verdict = "wrong"
    else:
        asked = next(least for fastest, least in SET_UP if frequency(rate) <= fastest)
        verdict = "right" if set_up is not None and set_up >= asked else "too late"
    return [*("-" if value is None else f"{value:.2f} us" for value in (latency, held, set_up)), verdict]


def row(rate: str) -> str:
    return f"| {' | '.join([rate, *figures(rate, USUAL), *figures(rate, HIGHEST)])} |\n"


def refreshed_limits(page: str) -> str:
    """Return the page with newly measured figures; a page without this table is unchanged."""
    if TABLE.search(page) is None:
        return page
    return TABLE.sub(lambda _: HEAD + "".join(map(row, RATES)), page)

"""Target speeds compared with the rows of a bench: one row for each target."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from periph_sim.form import COMPILED, INTERPRETED

from .images import BACK_TO_BACK, WITH_GAPS
from .levels import EXACT
from .recorded import FLAGS
from .start import SHORT

Row = dict[str, Any]
Parts = Mapping[str, Sequence[Row]]
Read = Callable[[Parts, str], float | None]
BYTES, DECLARED = "imu_hil, arithmetic = bytes, no budgets", "responder, waits declared"


def cell(parts: Parts, part: str, key: str, **wanted: str) -> float | None:
    """Return the figure of the only row with these values, or None if it was not measured."""
    for row in parts.get(part, ()):
        if all(row.get(name) == value for name, value in wanted.items()):
            found = row.get(key)
            return None if found is None else float(found)
    return None


def figure(part: str, key: str, **wanted: str) -> Read:
    """Return a function that reads the figure of the row with these values, for a form."""
    return lambda parts, form: cell(parts, part, key, form=form, **wanted)


def speed(case: str, level: str = EXACT) -> Read:
    return figure("levels", "bytes_per_s", case=case, level=level)


def recorded(way: str) -> Read:
    return figure("recorded", "times_as_long", case="imu_hil", recorded=way)


# Name, function that reads the figure, unit; targets of the compiled and the interpreted form, None without a target. A
# target is a minimum, or a maximum if the unit is a time or a factor of it ("x as long").
TARGETS: tuple[tuple[str, Read, str, float | None, float | None], ...] = (
    (BYTES, speed(BYTES), "bytes/s", 130_000, 7_000),
    ("imu_hil as it ships", speed("imu_hil"), "bytes/s", 75_000, 3_750),
    ("responder", speed("responder"), "bytes/s", 240_000, 6_400),
    ("two_dsps", speed("two_dsps"), "bytes/s", 60_000, 2_040),
    (DECLARED, speed(DECLARED), "bytes/s", 240_000, None),
    ("imu_hil, flags recorded", recorded(FLAGS), "x as long", 1.3, 1.3),
    ("imu_hil, .psr recorded", recorded(".psr"), "x as long", 2.0, 2.0),
    (SHORT, figure("start", "cpu_s", what=SHORT), "s", 0.003, 0.015),
    ("image, busy code", figure("images", "instructions_per_s", program="busy"), "instructions/s", 30_000_000, 150_000),
    (f"image, 250 ms of {BACK_TO_BACK}", figure("images", "cpu_s", program=BACK_TO_BACK), "s", 1, 30),
    (f"image, 250 ms of {WITH_GAPS}", figure("images", "cpu_s", program=WITH_GAPS), "s", 1, 30),
)
LESS_IS_BETTER = ("x as long", "s")


def rows(parts: Parts) -> Iterator[Row]:
    for what, read, unit, *wanted in TARGETS:
        for form, target in zip((COMPILED, INTERPRETED), wanted, strict=True):
            found = read(parts, form)
            if target is None or found is None:
                continue
            part = target / found if unit in LESS_IS_BETTER else found / target
            yield {"what": what, "form": form, "unit": unit, "target": target, "found": found, "part": part}


def line(row: Row) -> str:
    digits = ",.0f" if row["target"] >= 100 else ".4g"
    met = "reached" if row["part"] >= 1 else f"{row['part']:.2f} of it"
    sign = "<=" if row["unit"] in LESS_IS_BETTER else ">="
    found, target = (f"{row[which]:{digits}}" for which in ("found", "target"))
    return f"{row['what']:48} {row['form']:12} {found} {row['unit']}, {sign} {target}: {met}"

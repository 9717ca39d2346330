"""Rows of a trade: firmware of other kinds, arithmetics and recordings, with the most accurate first."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pytest

from periph_sim.interfaces.reports.trade.rows import AS_GIVEN, chosen, kind_of, rows_of
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase, Case
from periph_sim.scene.firmware_loader import load_firmware, settings_for
from tests.scene.runs import TIMING

OTHERS = ["record .psr", "record .vcd", "table"]


def maker(case: str, *changes: str) -> Callable[[Sequence[str]], Case]:
    return lambda more: load(TIMING / f"{case}.toml", [*changes, *more])


def names(case: str, *changes: str, others: Sequence[str] = ()) -> list[str]:
    return [row.name for row in rows_of(maker(case, *changes), [maker(other)([]) for other in others])]


def test_firmware_that_computes_models_has_rows_of_arithmetic():
    assert names("imu_hil") == ["arithmetic=float64", "arithmetic=float32", AS_GIVEN, *OTHERS]
    computed_in = "unit.dsp.settings.arithmetic="
    assert names("imu_hil", f"{computed_in}float64")[:3] == [AS_GIVEN, "arithmetic=float32", "arithmetic=q16"]
    assert names("imu_hil", f"{computed_in}q20")[-4] == AS_GIVEN


@pytest.mark.parametrize("case", ["imu_hil_published", "responder", "imu_hil_image", "imu_hil_c", "imu_chips"])
def test_firmware_that_computes_no_models_has_no_rows_of_arithmetic(case: str):
    assert names(case) == [AS_GIVEN, *OTHERS]


def test_firmware_of_other_cases_is_ordered_by_accuracy():
    found = names("imu_hil_published", others=["imu_hil_c", "imu_hil_image", "imu_hil"])
    assert found == ["image of imu_hil_image", "C of imu_hil_c", AS_GIVEN, "Python of imu_hil", *OTHERS]
    assert [kind_of(maker(case)([])) for case in ("imu_hil_image", "imu_hil_c", "two_dsps", "imu_chips")] == [
        "image",
        "C",
        "Python",
        "Python",
    ]


def test_units_of_another_case_replace_those_of_the_case():
    row = rows_of(maker("imu_hil_published"), [maker("imu_hil_image")([])])[0]
    case, given, other = (
        row.case(maker("imu_hil_published")),
        *(maker(f"imu_hil_{n}")([]) for n in ("published", "image")),
    )
    assert case.unit == other.unit and (case.name, case.host, case.budget) == (given.name, given.host, given.budget)


def test_all_arithmetics_take_the_time_stated_in_the_case():
    make = maker("imu_hil")
    costs = set()
    for row in rows_of(make, [])[:3]:
        unit = row.case(make).unit["dsp"]
        settings = settings_for(load_firmware(unit.firmware), unit.settings)
        costs.add(str(settings.run_cost))  # type: ignore[attr-defined]
    assert len(costs) == 1


def test_the_most_accurate_row_and_the_case_as_given_are_always_among_the_chosen():
    rows = rows_of(maker("imu_hil"), [])
    assert [row.name for row in chosen(rows, ["record .vcd"])] == ["arithmetic=float64", AS_GIVEN, "record .vcd"]
    assert chosen(rows, []) == [row for row in rows if row.name != "table"]  # the case has no table
    assert chosen(rows, ["table"])[-1].missing.startswith("rounds and frames")
    with pytest.raises(BadCase, match="there is no row 'byte' of this case"):
        chosen(rows, ["byte"])

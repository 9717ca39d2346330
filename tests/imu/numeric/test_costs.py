"""Counts and costs of operations: counting, estimates, and the source of each figure."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction

import pytest

from periph_sim.imu.models.counts import Counting
from periph_sim.imu.numeric import arithmetic_names as named
from periph_sim.imu.numeric.estimate import (
    DOUBLE,
    FASTRTS,
    IQMATH,
    OPERANDS,
    ROUNDED,
    RTS,
    SATURATED,
    estimate,
)
from periph_sim.imu.numeric.float64 import Float64

LIBRARIES = [IQMATH, ROUNDED, SATURATED, FASTRTS, RTS, DOUBLE]


def test_counting_changes_no_result_and_counts_each_kind() -> None:
    a = Counting(Float64())
    numbers = [a.add(1, 2), a.sub(1, 2), a.mul(3, 4), a.div(1, 4), a.neg(1), a.sqrt(4), a.mag(3, 4), a.atan(0)]
    numbers += [a.atan2(0, 1), *a.sincos(0), a.select_greater(1, 2, 3, 4), a.clamp(9, 0, 5), a.scaled(10, 0.5)]
    numbers += [a.to_integer(2.6, "nearest"), a.to_integer(2.6, "floor"), a.to_integer(-2.6, "toward zero")]
    assert numbers == [3, -1, 12, 0.25, -1, 2, 5, 0, 0, 0, 1, 4, 5, 5, 3, 2, -2]
    assert a.pop_counts() == Counter(OPERANDS.keys())
    assert a.pop_counts() == Counter()


@pytest.mark.parametrize("library", LIBRARIES, ids=lambda library: library.name)
def test_every_library_has_every_operation_with_a_source(library) -> None:
    assert set(library.costs) == set(OPERANDS)
    assert set(library.rom) <= set(OPERANDS) and library.with_operands <= set(OPERANDS)
    for kind, cost in library.costs.items():
        assert 0 < cost.low <= cost.high and cost.source, kind
        assert cost.guessed == (library is DOUBLE or ((library is RTS and cost.high == 1200) or cost.high == 2400)), (
            kind
        )


def test_an_estimate_sums_counts_times_cycles_and_operands() -> None:
    counts = {"one": {"sincos": 2, "add": 3}, "two": {"mul": 4, "add": 1, "select": 2}}
    iq = estimate(counts, IQMATH)
    assert iq.low == 2 * 90 + 3 + 4 * 6 + 1 + 2 * 3 + 2 * 3 + 4 * 3 + 2 * 5  # IQmpy's 6 include operands
    assert iq.high == iq.low + 2 * (9 - 3)
    assert iq.parts == {"one": (2 * 90 + 3 + 2 * 3 + 3 * 3,) * 2, "two": (iq.low - 198, iq.high - 198)}
    assert iq.counts == {"sincos": 2, "add": 4, "mul": 4, "select": 2}
    assert estimate(counts, IQMATH, "boot ROM").low == iq.low + 2 * 4
    assert iq.seconds() == Fraction(iq.low + iq.high, 300_000_000)
    assert iq.left_of(Fraction(1, 1_000_000)) == (150 - iq.high, 150 - iq.low)
    assert not iq.guessed and estimate(counts, DOUBLE).guessed and estimate(counts, RTS).guessed


def test_figures_of_the_manuals_and_figures_derived_from_instructions() -> None:
    """Derived from CMPL, a branch of 7 or 4 and MOVL, or a conditional MOVL; from ADDL and a shift; from a shift."""
    assert [IQMATH.costs[kind].low for kind in ("div", "sqrt", "mag", "atan2")] == [63, 63, 86, 109]
    assert [FASTRTS.costs[kind].low for kind in ("div", "sqrt", "sincos", "atan", "atan2")] == [25, 29, 44, 49, 50]
    assert (ROUNDED.costs["mul"].low, SATURATED.costs["mul"].low, RTS.costs["div"].low) == (17, 21, 222)
    kinds = ("select", "to integer, nearest", "to integer, floor", "to integer, toward zero", "clamp", "scaled")
    assert [(IQMATH.costs[kind].low, IQMATH.costs[kind].high) for kind in kinds] == [
        (3, 9),
        (2, 4),
        (1, 3),
        (14, 14),
        (7, 7),
        (7, 7),
    ]
    assert IQMATH.rom == {"sincos": 4, "atan": 6, "atan2": 6, "div": 8, "sqrt": 4, "mag": 4}


@pytest.mark.parametrize("name", ["float64", "float32", "q16", "q16 rounded", "q16 saturating", "q1", "q29"])
def test_a_name_selects_the_arithmetic_of_that_name(name: str) -> None:
    assert named.scalar(name).name == name
    assert set(named.library(name).costs) == set(OPERANDS)


@pytest.mark.parametrize("name", ["", "q", "Q16", "q16 wrapping", "float16", "q16  rounded", "q99999", "qq"])
def test_unknown_names_are_refused(name: str) -> None:
    with pytest.raises(named.NoSuchArithmetic, match="there is no arithmetic"):
        named.scalar(name)

"""Mean, p99 and worst error: an occurrence without a partner is infinite in each of them."""

from __future__ import annotations

from math import inf

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.reports.trade.errors import CYCLES, errors_of, within, worst_of
from periph_sim.reports.trade.pairing import Paired


def paired(*differences: int, lacking: int = 0, added: int = 0, disordered: int = 0) -> Paired:
    return Paired(np.array(differences, np.int64), lacking, added, disordered)


def test_errors_are_absolute_and_scaled():
    found = errors_of("flag", CYCLES, [paired(-20, 40), paired(0)], 20.0)
    assert (found.count, found.mean, found.worst, found.p99) == (3, 1.0, 2.0, 2.0)
    assert not found.exact


def test_what_does_not_occur_is_unmeasured_and_not_exact():
    found = errors_of("flag", CYCLES, [paired()])
    assert (found.count, found.worst, found.measured, found.exact) == (0, 0.0, False, False)
    assert errors_of("flag", CYCLES, [paired(0)]).measured and errors_of("flag", CYCLES, [paired(lacking=1)]).measured


@given(st.lists(st.integers(-100, 100)), st.integers(0, 3), st.integers(0, 3), st.integers(0, 3))
def test_one_without_a_partner_is_never_left_out(differences: list[int], lacking: int, added: int, changed: int):
    found = errors_of("flag", CYCLES, [paired(*differences, lacking=lacking, added=added, disordered=changed)])
    beyond = lacking + added + changed
    assert found.count == len(differences) + beyond
    assert (found.mean == inf) == (found.worst == inf) == bool(beyond)
    assert found.measured == (found.count > 0)
    assert found.exact == (found.measured and not beyond and not any(differences))


def test_p99_is_infinite_when_more_than_one_of_a_hundred_are():
    assert errors_of("flag", CYCLES, [paired(*[5] * 99, lacking=1)]).p99 == 5
    assert errors_of("flag", CYCLES, [paired(*[5] * 98, lacking=2)]).p99 == inf
    assert errors_of("flag", CYCLES, [paired(*range(1, 201))]).p99 == 198


def test_a_bound_in_cycles_lets_nothing_else_be_off():
    late, unlike = errors_of("flag", CYCLES, [paired(150)]), errors_of("bytes", "differ", [paired(1)])
    assert within([late], 150) and not within([late], 149)
    assert not within([late, unlike], 10**9)
    assert worst_of([late, unlike]) == 150 and worst_of([]) == 0

"""The worst error: an occurrence without a partner is infinite."""

from __future__ import annotations

from math import inf

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.reports.level_choice.errors import CYCLES, errors_of, within, worst_of
from periph_sim.reports.level_choice.pairing import Paired


def paired(*differences: int, unpaired: int = 0, disordered: bool = False) -> Paired:
    return Paired(np.array(differences, np.int64), unpaired, disordered)


def test_errors_are_absolute_and_scaled():
    found = errors_of("flag", CYCLES, [paired(-20, 40), paired(0)], 20.0)
    assert (found.count, found.worst) == (3, 2.0)
    assert not found.exact


def test_what_does_not_occur_is_unmeasured_and_not_exact():
    found = errors_of("flag", CYCLES, [paired()])
    assert (found.count, found.worst, found.measured, found.exact) == (0, 0.0, False, False)
    assert errors_of("flag", CYCLES, [paired(0)]).measured and errors_of("flag", CYCLES, [paired(unpaired=1)]).measured


@given(st.lists(st.integers(-100, 100), min_size=1), st.integers(0, 3), st.booleans())
def test_one_without_a_partner_is_never_left_out(differences: list[int], unpaired: int, changed: bool):
    found = errors_of("flag", CYCLES, [paired(*differences, unpaired=unpaired, disordered=changed)])
    assert found.count == len(differences) + unpaired and found.measured
    assert (found.worst == inf) == (unpaired > 0 or changed)
    assert found.exact == (found.worst == 0) == (not unpaired and not changed and not any(differences))


def test_a_bound_in_cycles_lets_nothing_else_be_off():
    late, unlike = errors_of("flag", CYCLES, [paired(150)]), errors_of("bytes", "differ", [paired(1)])
    assert within([late], 150) and not within([late], 149)
    assert not within([late, unlike], 10**9)
    assert worst_of([late, unlike]) == 150 and worst_of([]) == 0

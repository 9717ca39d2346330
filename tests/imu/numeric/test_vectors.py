"""Vector operations of Q equal those on single numbers, to the last bit and with the same overflows."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.imu.numeric.arithmetic import Vectors, vectors_of
from periph_sim.imu.numeric.q import HIGH, LOW, Q, RoundedQ

NUMBER = st.integers(LOW, HIGH) | st.integers(-1 << 20, 1 << 20)
TRIPLE = st.tuples(NUMBER, NUMBER, NUMBER)


@pytest.mark.parametrize("kind", [Q, RoundedQ])
@pytest.mark.parametrize("overflow", ["wrap", "saturate"])
@given(TRIPLE, TRIPLE, NUMBER)
def test_vector_operations_equal_those_on_numbers(kind: type[Q], overflow: str, u: tuple, v: tuple, k: int) -> None:
    own, plain = kind(16, overflow), kind(16, overflow)
    vectors = vectors_of(own)
    assert vectors is own
    by_numbers = Vectors(plain)
    low, high = sorted(u[:2])
    of = {"plus": (u, v), "minus": (u, v), "times": (u, k), "transformed": ((u, v, u), v), "cross": (u, v)}
    of |= {"turned": (*u, k), "whole": (v, low, high, "nearest")}
    for name, given_ in of.items():
        assert getattr(vectors, name)(*given_) == getattr(by_numbers, name)(*given_), name
        assert own.overflows == plain.overflows, name

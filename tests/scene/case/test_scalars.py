"""Limits of the numbers in case files: the first and last values are accepted, their neighbours are refused."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from periph_sim.core.convert import BadTable
from periph_sim.core.table import Table
from periph_sim.scene.case.scalars import (
    Address,
    Answer,
    Bits,
    BusRate,
    Byte,
    CodeCycles,
    Crystal,
    Exact,
    Length,
    PassCycles,
    Ppm,
    RateError,
    VariableValues,
)


class Values(Table, frozen=True, kw_only=True):
    address: Address = 0
    answer: Answer = 0
    bits: Bits = Fraction(0)
    bus_rate: BusRate = Fraction(1)
    byte: Byte = 0
    code_cycles: CodeCycles = 0
    crystal: Crystal = Fraction(30_000_000)
    exact: Exact = Fraction(0)
    length: Length = Fraction(1)
    pass_cycles: PassCycles = 1
    ppm: Ppm = Fraction(0)
    rate_error: RateError = Fraction(0)
    variables: VariableValues = {}


def taken(key: str, value: object) -> Any:
    return getattr(Values.model_validate({key: value}), key)


@pytest.mark.parametrize(
    ("key", "below", "first", "last", "above"),
    [
        ("address", -1, 0, 0x7F, 0x80),
        ("bits", -0.001, 0, 10**9, None),
        ("bus_rate", "0 Hz", "1 Hz", "5 MHz", "5.000001 MHz"),
        ("byte", -1, 0, 0xFF, 0x100),
        ("code_cycles", -1, 0, 1000, 1001),
        ("crystal", "3.999999 MHz", "4 MHz", "150 MHz", "150.000001 MHz"),
        ("length", "0 s", "1 ns", "1 h", None),
        ("pass_cycles", 0, 1, 1000, 1001),
        ("ppm", -100_000.001, -100_000, 100_000, 100_000.001),
        ("rate_error", -50.001, -50, 50, 50.001),
    ],
)
def test_the_limits_of_a_number(key: str, below: object, first: object, last: object, above: object):
    for value in (first, last):
        taken(key, value)
    for value in (below, above):
        if value is not None:
            with pytest.raises(BadTable):
                taken(key, value)


@pytest.mark.parametrize(
    ("value", "number"),
    [(3, Fraction(3)), (0.1, Fraction(1, 10)), ("1/3", Fraction(1, 3)), (Fraction(2, 7), Fraction(2, 7))],
)
def test_a_number_is_exactly_what_is_written(value: object, number: Fraction):
    assert taken("exact", value) == number


@pytest.mark.parametrize("value", [True, [], {}, None])
def test_other_types_than_numbers_are_refused(value: object):
    with pytest.raises(BadTable, match="is not a number"):
        taken("exact", value)


@pytest.mark.parametrize(("value", "fits"), [("fall9", True), (3, True), (True, True), (0.5, False), ([], False)])
def test_an_answer_is_a_text_a_whole_number_or_a_boolean(value: object, fits: bool):
    if fits:
        assert taken("answer", value) == value
        return
    with pytest.raises(BadTable, match="expected a text, a whole number, true or false"):
        taken("answer", value)


def test_members_of_structures_have_their_full_names():
    tree = {"limit": 5, "timer": {"count": 3, "of": {"port": {"bit": 1}}}, "gain": 0.5}
    assert taken("variables", tree) == {"limit": 5, "timer.count": 3, "timer.of.port.bit": 1, "gain": 0.5}
    with pytest.raises(BadTable):
        taken("variables", 3)

"""Separate copies of tables of a case file: changes of a copy do not reach the original."""

from __future__ import annotations

from fractions import Fraction

from periph_sim.core.table import Table, separate


class Inner(Table, frozen=True, kw_only=True):
    pins: dict[str, int] = {}
    length: Fraction = Fraction(1)


class Outer(Table, frozen=True, kw_only=True):
    inner: tuple[Inner, ...] = ()
    settings: dict[str, object] = {}
    name: str = ""


def test_changes_of_a_separate_table_leave_the_original():
    one = Outer(inner=(Inner(pins={"a": 1}),), settings={"deep": [{"x": 1}], "n": 3}, name="o")
    other = separate(one)
    assert other == one
    other.inner[0].pins["b"] = 2
    other.settings["deep"][0]["x"] = 5
    other.settings["deep"].append(7)
    assert one == Outer(inner=(Inner(pins={"a": 1}),), settings={"deep": [{"x": 1}], "n": 3}, name="o")


def test_immutable_values_are_not_copied():
    plain = (1, "a", Fraction(1, 3), (b"b", None))
    assert separate(plain) is plain
    several = separate((Fraction(1), [plain]))
    assert several[1][0] is plain

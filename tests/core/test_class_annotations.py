"""Annotations of classes of modules without the future import `annotations`, which Python 3.14 stores otherwise."""

# No future import here: this file is what it tests.
from dataclasses import dataclass
from fractions import Fraction

from periph_sim.core.convert import convert
from periph_sim.core.table import Duration


@dataclass
class Base:
    length: Duration
    count: int = 3


@dataclass
class Settings(Base):
    name: "str" = ""


def test_the_keys_of_such_a_class_are_converted() -> None:
    made = convert(Settings, {"length": "2 ms", "name": "a"})
    assert (made.length, made.count, made.name) == (Fraction(1, 500), 3, "a")

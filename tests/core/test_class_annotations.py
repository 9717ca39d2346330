"""Classes of modules without the future import `annotations`, whose annotations Python 3.14 stores differently."""

# This file has no future import, because it is itself the module under test.
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


def test_keys_of_a_class_without_the_future_import_are_converted() -> None:
    made = convert(Settings, {"length": "2 ms", "name": "a"})
    assert (made.length, made.count, made.name) == (Fraction(1, 500), 3, "a")

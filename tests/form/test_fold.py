"""Constants become numbers where a compiled module would look them up; lines stay where they are."""

from __future__ import annotations

from periph_sim.core import chip
from periph_sim.form.fold import declared, folded

SOURCE = """\
WORD = 16

class Box:
    __slots__ = ("level",)
    level: int

    def f(self, x):
        return x | WORD if x > at.NO_CHANGE else LOW
"""


def test_constants_stand_in_their_places():
    text = folded(SOURCE, {"WORD": 16, "LOW": -3, "at": chip})
    assert text.splitlines()[-1] == f"        return x | 16 if x > {chip.NO_CHANGE} else (-3)"
    assert len(text.splitlines()) == len(SOURCE.splitlines())


def test_what_is_no_whole_number_stays():
    text = folded(SOURCE, {"WORD": True, "LOW": "low", "at": chip})
    assert text.splitlines()[-1] == f"        return x | WORD if x > {chip.NO_CHANGE} else LOW"


def test_a_wide_constant_is_declared_as_wide_as_it_is():
    text = folded(SOURCE, {"WORD": 1 << 62})
    assert f"PERIPH_SIM_{1 << 62}" in text
    assert f"const long long PERIPH_SIM_{1 << 62}" in declared(text, "")
    beyond = folded(SOURCE, {"WORD": 1 << 63, "LOW": 1 << 88})
    assert "WORD" in beyond and "LOW" in beyond and "PERIPH_SIM" not in beyond
    assert declared("x = 1", "cdef class Box: pass") == "cdef class Box: pass"

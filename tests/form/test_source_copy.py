"""The copies of sources that Cython compiles contain its decorators and types, and lines keep their numbers."""

from __future__ import annotations

import ast
import re
from enum import Enum
from pathlib import Path

import pytest

from periph_sim.core import chip
from periph_sim.form.source_copy import declared, prepared, with_constants
from periph_sim.form.sources import Sources
from tests.form.package import classes

REGISTERS = """\
# core: compiled
SIZE = 16

class Cpu:
    ovc: int

def half(cpu: Cpu) -> int:
    return 8

def whole(cpu: Cpu) -> int:
    return 16
"""
HEAD = '''"""A module."""
# core: compiled
from __future__ import annotations

'''


def copied(tmp_path: Path, source: str) -> str:
    (tmp_path / "registers.py").write_text(REGISTERS)
    (tmp_path / "one.py").write_text(HEAD + source)
    text = prepared(Sources(tmp_path)["one"])
    assert text.count("\n") == (HEAD + source).count("\n")
    return text.removeprefix(HEAD)


def test_the_directive_for_a_free_list_is_inserted_above_its_class(tmp_path: Path):
    text = copied(tmp_path, "ONE = 1\n\n\nclass Kept:  # core: freelist 4\n    pass\n")
    assert text.startswith('"""A module."""\n# core: compiled\nfrom __future__ import annotations; import cython\n')
    assert text.endswith("ONE = 1\n@cython.freelist(4)\n@cython.cclass\nclass Kept:  # core: freelist 4\n    pass\n")
    text = copied(tmp_path, "ONE = 1\n\n\n@final\nclass Kept:  # core: freelist 4\n    pass\n")
    assert text.endswith("ONE = 1\n\n@cython.freelist(4)\n@cython.cclass\nclass Kept:  # core: freelist 4\n    pass\n")


def test_every_free_list_of_the_package_is_inserted():
    kept = [kind for kind in classes() if kind.marks]
    assert len(kept) > 1
    for kind in kept:
        assert re.search(rf"\n@cython\.freelist\(\d+\)\n@cython\.cclass\nclass {kind.name}\b", prepared(kind.source))


def test_decorators_and_types_without_values_are_left_out(tmp_path: Path):
    source = """\
@final
class One:
    count: int
    def f(self) -> None:
        for one in self:
            place: int
            place = 1
class Plain(NamedTuple):
    count: int
"""
    expected = source.replace("@final", "").replace("count: int", "pass", 1).replace("place: int", "pass")
    assert copied(tmp_path, source) == expected


def test_bare_returns_of_functions_without_a_result_return_false(tmp_path: Path):
    source = """\
class Box:
    def act(self, tag: int) -> None:
        if tag:
            return  # nothing to do
    def weigh(self) -> int | None:
        return
    def stay(self) -> None:  # core: python
        return
    def _hold(self) -> None:
        def wait() -> None:
            return
"""
    assert copied(tmp_path, source) == source.replace("return  # nothing", "return False  # nothing")


def test_c_functions_are_not_imported(tmp_path: Path):
    source = """\
from .registers import (
    SIZE,
    Cpu,
    half,
)
from .registers import whole
def helper(cpu: Cpu) -> int:
    return half(cpu) + whole(cpu) + SIZE
"""
    lines = copied(tmp_path, source).splitlines()
    assert lines[:7] == ["from .registers import SIZE, Cpu", "", "", "", "", "", "def helper(cpu: Cpu) -> int:"]


def test_a_c_function_that_is_used_as_a_value_is_imported(tmp_path: Path):
    source = "from .registers import half\ndef f(cpu: object) -> int:\n    return half(cpu)\nx = sorted([], key=half)\n"
    assert copied(tmp_path, source) == source


def test_a_look_up_in_globals_becomes_comparisons_of_names(tmp_path: Path):
    source = """\
__all__ = ("NOP", "bind")
def NOP(cpu: object) -> None:
    pass
def ADD(cpu: object) -> None:
    pass
def SUB(cpu: object) -> None:
    pass
def helper(cpu: object) -> None:
    pass
def bind(cpu: object, name: str) -> None:
    cpu.does = globals()[name]
"""
    (tmp_path / "one.py").write_text(HEAD + source)
    text = prepared(Sources(tmp_path)["one"])
    names: dict[str, object] = {}
    exec(text, names)

    class Box:
        does: object = 0

    box, bind = Box(), names["bind"]
    assert callable(bind)
    bind(box, "SUB")
    assert box.does is names["SUB"]
    for none in ("helper", "NOP"):
        with pytest.raises(KeyError, match=none):
            bind(box, none)
    assert "globals" not in text


def test_types_that_the_declarations_define_are_not_defined_again(tmp_path: Path):
    assert copied(tmp_path, "Run = CFunction[[int], None]\nx = 1\n") == "\nx = 1\n"


def test_a_source_without_these_constructs_is_unchanged(tmp_path: Path):
    source = "def f(x: int) -> int:\n    y: int = x\n    return y\n"
    assert copied(tmp_path, source) == source


SOURCE = """\
WORD = 16

class Box:
    __slots__ = ("level",)
    level: int

    def f(self, x):
        return x | WORD if x > at.NO_CHANGE else LOW
"""


def test_constants_replace_their_names():
    text = with_constants(SOURCE, {"WORD": 16, "LOW": -3, "at": chip})
    assert text.splitlines()[-1] == f"        return x | 16 if x > {chip.NO_CHANGE} else (-3)"
    assert len(text.splitlines()) == len(SOURCE.splitlines())


def test_names_of_other_values_than_integers_are_unchanged():
    text = with_constants(SOURCE, {"WORD": True, "LOW": "low", "at": chip})
    assert text.splitlines()[-1] == f"        return x | WORD if x > {chip.NO_CHANGE} else LOW"


def test_a_wide_constant_is_declared_as_long_long():
    text = with_constants(SOURCE, {"WORD": 1 << 62})
    assert f"PERIPH_SIM_{1 << 62}" in text
    assert f"const long long PERIPH_SIM_{1 << 62}" in declared(text, "")
    beyond = with_constants(SOURCE, {"WORD": 1 << 63, "LOW": 1 << 88})
    assert "WORD" in beyond and "LOW" in beyond and "PERIPH_SIM" not in beyond
    assert declared("x = 1", "cdef class Box: pass") == "cdef class Box: pass"


class Kind(Enum):
    EDGE = "edge"
    FLAG = "flag"


MEMBERS = """\
from .records import (
    Kind,
    Record,
)

class Own(Kind):
    µ = Kind.EDGE; also = Kind.FLAG

def is_flag(kind):
    return kind is Kind.FLAG or Kind.FLAG.value == Kind.names or Own.EDGE or other.Kind.EDGE
"""


def test_a_member_of_an_enumeration_is_bound_where_its_class_is_imported():
    lines = with_constants(MEMBERS, {"Kind": Kind, "Own": Kind}).split("\n")
    assert lines[3].startswith(")") and sorted(lines[3].split("; ")[1:]) == [
        "Kind_EDGE = Kind.EDGE",
        "Kind_FLAG = Kind.FLAG",
    ]
    assert lines[6] == "    µ = Kind_EDGE; also = Kind_FLAG"
    # unchanged: an attribute that is no member, a class of this module, and a class of another module
    said = "    return kind is Kind_FLAG or Kind_FLAG.value == Kind.names or Own.EDGE or other.Kind.EDGE"
    assert lines[9] == said
    assert len(lines) == len(MEMBERS.split("\n"))
    ast.parse("\n".join(lines))


def test_members_of_other_classes_than_enumerations_are_unchanged():
    assert with_constants(MEMBERS, {"Kind": object()}) == MEMBERS

"""Declarations derived from small sources; a source without a declaration is refused with file and line."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from periph_sim.form.compiled_class import BadDeclaration
from periph_sim.form.declarations import declarations, used_by
from periph_sim.form.sources import Sources
from tests.form.package import classes, every_declaration, package

OTHER = """\
# core: compiled
from array import array as Buffer

NEVER = 1 << 62
SIZE = 4


class Agent:
    now: int

    def act(self, tag: int) -> None:
        pass

    def find(self) -> Agent | None:
        return None


class Report:  # core: python
    pass


def half(value: int) -> int:
    return value >> 1
"""


def declared(tmp_path: Path, source: str) -> list[str]:
    """Return the lines of the .pxd file of a module next to `other`, without the lines that every .pxd file has."""
    (tmp_path / "other.py").write_text(OTHER)
    (tmp_path / "one.py").write_text(f"# core: compiled\n{source}")
    text = declarations(Sources(tmp_path)["one"]).text
    _, _, after = text.partition("const long long PERIPH_SIM_RAISED\n")
    return [line for line in after.split("\n") if line]


CASES = {
    "annotated attributes": (
        """
class A:
    n: int
    on: bool
    next: A | None
    text: str
    any: Iterable[int]
    LIMIT: int
""",
        """
cdef class A:
    cdef public long long n
    cdef public bint on
    cdef public A next
    cdef public str text
    cdef public object any
""",
    ),
    "attributes by their first values": (
        """
from .other import NEVER, Agent
class A:
    def __init__(self, agent: Agent, count: int) -> None:
        self.agent, self.count, self._due = agent, count + 1, NEVER
        self.now = agent.now
        self.all = [agent]
        self.found: dict[int, Agent] = make()
    def reset(self) -> None:
        self.on = False
""",
        """
from .other cimport Agent
cdef class A:
    cdef public dict found
    cdef public Agent agent
    cdef public long long count
    cdef public long long _due
    cdef public long long now
    cdef public list all
    cdef public bint on
    cpdef bint reset(self) except -1
""",
    ),
    "arrays, buffers and numbers of other widths": (
        """
from .other import SIZE
from .form.c_types import BigInt, Buffer, Text, UInt32
class A:
    r: Annotated[list[int], 8]
    _row: Annotated[list[UInt32], 2 * SIZE]
    _late: Buffer[int]
    wide: BigInt
    place: Text
""",
        """
cdef class A:
    cdef public long long[8] r
    cdef public unsigned int[8] _row
    cdef long long[::1] _late
    cdef public object wide
    cdef public object place
""",
    ),
    "a final class with a base": (
        """
from .other import Agent
@final
class A(Agent):  # core: freelist 4
    def act(self, tag: int) -> None: ...
    def more(self) -> int: ...
""",
        """
from .other cimport Agent
@cython.final
@cython.freelist(4)
cdef class A(Agent):
    cpdef long long more(self) except? PERIPH_SIM_RAISED
""",
    ),
    "an override in a class that may have subclasses": (
        """
from .other import Agent
class A(Agent):
    def act(self, tag: int) -> None:
        left: int = tag
""",
        """
from .other cimport Agent
cdef class A(Agent):
    @cython.locals(left=cython.longlong)
    cpdef bint act(self, long long tag) except -1
""",
    ),
    "a class that is named before it is defined": (
        """
class A:
    last: B
class B:
    pass
""",
        """
cdef class B
cdef class A:
    cdef public B last
cdef class B:
    pass
""",
    ),
    "classes that stay Python's": (
        """
from .other import Agent, Report
class A(Report): ...
class B(Agent, Report): ...
@dataclass
class C: ...
class D(NamedTuple): ...
""",
        """
""",
    ),
    "methods by their names": (
        """
class A:
    def open(self, by: int = 0) -> bool: ...
    def _shut(self, it: A | None) -> None: ...
    def show(self, it: A | None, other: A | None = None) -> str: ...
    def __len__(self) -> int: ...
""",
        """
cdef class A:
    cpdef bint open(self, long long by=*) except -1
    cdef bint _shut(self, A it) except -1
    cpdef str show(self, object it, A other=*)
""",
    ),
    "a method that is called on another object, whose class is not known": (
        """
class A:
    def _judge(self) -> bool: ...
    def _all(self, parts: Iterable[A]) -> bool:
        return all([part._judge() for part in parts])
""",
        """
cdef class A:
    cpdef bint _judge(self) except -1
    cdef bint _all(self, object parts) except -1
""",
    ),
    "methods by their marks": (
        """
class A:
    def one(self) -> None:  # core: python
        pass
    def two(  # core: C only
        self, a: int
    ) -> None: ...
""",
        """
cdef class A:
    cdef bint two(self, long long a) except -1
""",
    ),
    "methods that stay Python's": (
        """
class A:
    def a(self, *, n: int) -> None: ...
    def b(self) -> None:
        yield 1
    def c(self) -> None:
        sum(n for n in self)
    @property
    def d(self) -> int: ...
    def e(self) -> None: ...
    def f(self) -> None:
        later(self.e)
    def g(self) -> None:
        super().g()
""",
        """
cdef class A:
    cpdef bint f(self) except -1
""",
    ),
    "functions": (
        """
from .other import half
def twice(value: int) -> int:  # core: noexcept
    return 4 * half(value)
def _wide(place: int) -> None:
    pass
def _key(value: int) -> int: ...
x = sorted(x, key=_key)
""",
        """
from .other cimport half
cpdef long long twice(long long value) noexcept
cdef bint _wide(long long place) except -1
""",
    ),
    "functions that Python may call": (
        """
__all__ = ("bind",)
def bind(name: str) -> None: ...
def ADD(by: int) -> None: ...
""",
        """
cpdef bint bind(str name) except -1
cdef bint ADD(long long by) except -1
""",
    ),
    "a pointer to a C function": (
        """
Run = CFunction[["A", int], None]
class A:
    run: Run

def bind(a: A) -> None:
    a.run = _go

def _go(a: A, n: int) -> None: ...
""",
        """
ctypedef bint (*Run)(A, long long) except -1
cdef class A:
    cdef Run run
cpdef bint bind(A a) except -1
cdef bint _go(A a, long long n) except -1
""",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_a_source_has_its_declarations(tmp_path: Path, case: str):
    source, expected = CASES[case]
    assert declared(tmp_path, source) == expected.split("\n")[1:-1]


BAD = {
    "class A:\n    def __init__(self, it):\n        self.x = it.x\n": (
        "one.py:4: nothing says the type of A.x; annotate it in the class"
    ),
    "class A:\n    n: int\n    def __init__(self) -> None:\n        self.n: str = ''\n": (
        "one.py:5: A.n is str here and long long in another annotation"
    ),
    "class A:  # core: freelist\n    pass\n": "one.py:2: '# core: freelist' at A; expected python|freelist \\d+",
    "def f() -> None:  # core: nothrow\n    pass\n": (
        "one.py:2: '# core: nothrow' at f; expected python|C only|noexcept"
    ),
    "@final\nclass A: ...\nclass B(A): ...\n": "one.py:4: class B has the base A, which is @final",
    "from .other import Agent\nclass A(Agent):\n    def act(self, tag: int) -> None:\n        later(lambda: tag)\n": (
        "one.py:4: A.act cannot be compiled as the C method that it overrides can; mark that one '# core: python'"
    ),
    "from .other import Agent\nclass A(Agent):\n    def act(self, tag: int, more: int = 0) -> None: ...\n": (
        "one.py:4: act takes other arguments than the method that it overrides"
    ),
    "class A:\n    r: Annotated[list[int], HOW_MANY]\n": "one.py:3: the length HOW_MANY of an array; expected a number",
}


@pytest.mark.parametrize("source", BAD)
def test_the_error_of_a_source_that_cannot_be_declared_names_its_line(tmp_path: Path, source: str):
    with pytest.raises(BadDeclaration, match=f"^{re.escape(BAD[source])}$"):
        declared(tmp_path, source)


def test_a_misspelt_mark_of_a_module_is_reported(tmp_path: Path):
    (tmp_path / "one.py").write_text("\n# core: compild\n")
    said = "one.py:2: '# core: compild'; expected '# core: compiled' or '# core: compiled without checks for None'"
    with pytest.raises(BadDeclaration, match=f"^{re.escape(said)}$"):
        Sources(tmp_path).compiled()


def test_a_module_is_rebuilt_if_types_that_it_uses_change(tmp_path: Path):
    """core.clock uses types of core.time, which uses those of core.chip; core.fifo imports a type without using it."""
    (tmp_path / "core").mkdir()
    sources = {
        "chip": "class Chip: ...\n",
        "time": "from .chip import Chip\nclass Time(Chip): ...\n",
        "clock": "from ..core.time import Time\nclass Clock:\n    time: Time\n",
        "fifo": "from .chip import Chip\n",
    }
    for name, text in sources.items():
        (tmp_path / "core" / f"{name}.py").write_text(f"# core: compiled\n{text}")
    package = Sources(tmp_path)
    assert package.compiled() == ["core.chip", "core.clock", "core.fifo", "core.time"]
    assert {name: used_by(package, f"core.{name}") for name in sources} == {
        "chip": {"core.chip"},
        "time": {"core.time", "core.chip"},
        "clock": {"core.clock", "core.time", "core.chip"},
        "fifo": {"core.fifo"},
    }


def test_every_module_of_the_package_has_declarations():
    assert "core.kernel" in package().compiled()
    assert "\n".join(every_declaration()).count("\ncdef class ") >= len(classes()) > 100

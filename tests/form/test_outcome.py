"""The result of a C function tells whether it raised, whatever the sources say that it returns."""

from __future__ import annotations

from periph_sim.form.outcome import resultless, returning, telling

TYPES = """\
cdef class Box(Agent):
    cdef public long long level
    cpdef void act(self, long long tag)
    cdef void _open(self, long long by=*)
    cpdef long long weigh(self)
    cdef bint empty(self)
    cdef list all(self)
"""

SOURCE = """\
class Box(Agent):
    def act(self, tag: int) -> None:
        if tag:
            return  # nothing to do
        later(lambda: tag)

        def wait() -> None:
            return

    def weigh(self) -> None:
        return
"""


def test_a_result_tells():
    assert resultless([TYPES]) == {"act", "_open"}
    raised, told = telling(TYPES).split("cdef class")
    assert told.splitlines()[2:] == [
        "    cpdef bint act(self, long long tag) except -1",
        "    cdef bint _open(self, long long by=*) except -1",
        "    cpdef long long weigh(self) except? PERIPH_SIM_RAISED",
        "    cdef bint empty(self) except -1",
        "    cdef list all(self)",
    ]
    assert "const long long PERIPH_SIM_RAISED" in raised


def test_their_bare_returns_name_it_and_no_others():
    before, after = SOURCE.splitlines(), returning(SOURCE, ["act"]).splitlines()
    changed = [row for row, (old, new) in enumerate(zip(before, after, strict=True)) if old != new]
    assert changed == [3] and after[3] == "            return False  # nothing to do"


def test_a_type_that_no_method_of_it_needs_stays_as_it_is():
    assert telling("cdef class Box:\n    cdef object void") == "cdef class Box:\n    cdef object void"
    assert returning(SOURCE, []) == SOURCE

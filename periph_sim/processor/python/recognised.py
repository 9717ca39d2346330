"""Recognition of functions that are equivalent to a `Condition`.

    lambda: i2c.I2CSTR.XRDY == 1   --seen before--> its code: i2c, I2CSTR, XRDY, ==, 1 --> Condition

The first wait calls the function. Only a comparison of a field of a module's register with a number is recognised:
firmware cannot give it another meaning. The place of the read in records is the function's line.
"""

# core: compiled

from __future__ import annotations

import sys
from dis import get_instructions
from functools import lru_cache
from types import CodeType, FunctionType
from typing import NamedTuple, final

from ...form.c_types import BigInt
from ..source_location import SourceLocation
from .conditions import ABOVE, BELOW, EQUAL, UNEQUAL, Condition
from .port_fields import Port, Registers
from .program import PythonProgram

TESTS = {"==": EQUAL, "!=": UNEQUAL, "<": BELOW, ">": ABOVE}
NOTHING = frozenset(("RESUME", "COPY_FREE_VARS", "NOP", "CACHE", "PRECALL"))  # opcodes without effect here
FORM = ("LOAD_DEREF", "LOAD_ATTR", "LOAD_ATTR", "LOAD_CONST", "COMPARE_OP", "RETURN_VALUE")


class FieldComparison(NamedTuple):
    """A comparison of a field with a number. place: index of the module among the function's free variables.

    line: the line that reads the field.
    """

    place: int
    register: str
    field: str
    test: int
    number: int
    line: int


@lru_cache(maxsize=256)  # the query depends on the code alone, so the firmware of all scenes shares it
def comparison_of(code: CodeType) -> FieldComparison | None:
    """Return the comparison that a code makes; None if it has another form."""
    if code.co_argcount or code.co_kwonlyargcount or code.co_flags & 0x0C:
        return None
    steps = [step for step in get_instructions(code) if step.opname not in NOTHING]
    names = ["LOAD_CONST" if step.opname == "LOAD_SMALL_INT" else step.opname for step in steps]
    if tuple(names) != FORM:
        return None
    module, register, field, number, test, _ = [step.argval for step in steps]
    if test not in TESTS or type(number) is not int or module not in code.co_freevars:
        return None
    at = steps[2].positions
    line = at.lineno if at is not None and at.lineno is not None else code.co_firstlineno
    return FieldComparison(code.co_freevars.index(module), register, field, TESTS[test], number, line)


@final
class ConditionQuery:
    """The query of a code. condition: its condition on the module used last."""

    __slots__ = ("code", "condition", "field", "known", "module", "number", "place", "register", "test", "where")

    number: BigInt

    def __init__(self, code: CodeType) -> None:
        self.code = code  # kept, so that its id stays unique
        self.known = False  # it was analysed
        # Index of the module among the function's free variables; -1: the code has another form.
        self.place = -1
        self.register = self.field = ""
        self.test = EQUAL
        self.number = 0
        self.where: SourceLocation | None = None  # in the firmware
        self.module: Registers | None = None
        self.condition: Condition | None = None

    def analyse(self, program: PythonProgram) -> None:
        """Set the query from the code."""
        self.known = True
        found = None if sys.gettrace() is not None else comparison_of(self.code)
        if found is not None:
            self.place, self.register, self.field, self.test, self.number, line = found
            self.where = program.place_in(self.code, line)

    def condition_on(self, module: object) -> Condition | None:
        """Return the condition on this module's register; None if there is none."""
        self.module = self.condition = None
        if isinstance(module, Registers):
            port = vars(module).get(self.register)
            if isinstance(port, Port):
                self.module, self.condition = module, port.comparison(self.field, self.number, self.test, self.where)
        return self.condition


@final
class Recogniser:
    """Queries of one CPU's firmware."""

    __slots__ = ("_earlier", "_latest", "_program", "_queries")

    def __init__(self, program: PythonProgram) -> None:
        self._program = program
        self._queries: dict[int, ConditionQuery] = {}
        self._latest: ConditionQuery | None = None  # used last; a loop repeats the same one or two
        self._earlier: ConditionQuery | None = None  # used before it

    def condition(self, function: object) -> Condition | None:
        """Return the condition equivalent to a function that was seen before; None if there is none."""
        if type(function) is not FunctionType:
            return None
        code = function.__code__
        query: ConditionQuery | None = self._latest
        if query is None or query.code is not code:
            query, self._earlier = self._earlier, query
            if query is None or query.code is not code:
                query = self._queries.get(id(code))
                if query is None:
                    query = self._queries[id(code)] = ConditionQuery(code)
                    self._latest = query
                    return None
            self._latest = query
        if not query.known:
            query.analyse(self._program)
        if query.place < 0:
            return None
        try:
            module = function.__closure__[query.place].cell_contents  # type: ignore[index]
        except ValueError:  # not yet assigned
            return None
        return query.condition if module is query.module else query.condition_on(module)

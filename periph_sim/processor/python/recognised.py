"""Functions that ask what a condition could: one of the firmware goes in; the condition comes out, where it is one.

    lambda: i2c.I2CSTR.XRDY == 1   --seen before--> its code: i2c, I2CSTR, XRDY, ==, 1 --> Condition

The first wait calls the function. Recognised is only a field of a register of a module beside a number: nothing that
firmware could give another meaning. Where records of the read tell its place, that is the function's line.
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
NOTHING = frozenset(("RESUME", "COPY_FREE_VARS", "NOP", "CACHE", "PRECALL"))  # opcodes that do nothing here
FORM = ("LOAD_DEREF", "LOAD_ATTR", "LOAD_ATTR", "LOAD_CONST", "COMPARE_OP", "RETURN_VALUE")


class Asked(NamedTuple):
    """A field of a register beside a number. place: of the module among the variables from around the function.

    line: in which the field is read.
    """

    place: int
    register: str
    field: str
    test: int
    number: int
    line: int


@lru_cache(maxsize=256)  # what a code asks is in the code alone, so the firmware of all scenes shares it
def asked_by(code: CodeType) -> Asked | None:
    """None where it asks otherwise."""
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
    return Asked(code.co_freevars.index(module), register, field, TESTS[test], number, line)


@final
class Question:
    """What a code asks. condition: about the module that the function named last."""

    __slots__ = ("code", "condition", "field", "known", "module", "number", "place", "register", "test", "where")

    number: BigInt

    def __init__(self, code: CodeType) -> None:
        self.code = code  # kept, so that its id is nobody else's
        self.known = False  # it was taken apart
        # Of the module among the variables that the function takes from around it; -1: it asks otherwise.
        self.place = -1
        self.register = self.field = ""
        self.test = EQUAL
        self.number = 0
        self.where: SourceLocation | None = None  # in the firmware
        self.module: Registers | None = None
        self.condition: Condition | None = None

    def take_apart(self, program: PythonProgram) -> None:
        self.known = True
        asked = None if sys.gettrace() is not None else asked_by(self.code)
        if asked is not None:
            self.place, self.register, self.field, self.test, self.number, line = asked
            self.where = program.place_in(self.code, line)

    def about(self, module: object) -> Condition | None:
        """The condition on this module's register; None where there is none."""
        self.module = self.condition = None
        if isinstance(module, Registers):
            port = vars(module).get(self.register)
            if isinstance(port, Port):
                self.module, self.condition = module, port.asked(self.field, self.number, self.test, self.where)
        return self.condition


@final
class Recogniser:
    """One CPU's: what was seen of its firmware's functions."""

    __slots__ = ("_earlier", "_latest", "_program", "_questions")

    def __init__(self, program: PythonProgram) -> None:
        self._program = program
        self._questions: dict[int, Question] = {}
        self._latest: Question | None = None  # asked last; a loop asks the same one or two again and again
        self._earlier: Question | None = None  # before it

    def condition(self, function: object) -> Condition | None:
        """What the function asks, if it was seen before and asks it so."""
        if type(function) is not FunctionType:
            return None
        code = function.__code__
        question: Question | None = self._latest
        if question is None or question.code is not code:
            question, self._earlier = self._earlier, question
            if question is None or question.code is not code:
                question = self._questions.get(id(code))
                if question is None:
                    question = self._questions[id(code)] = Question(code)
                    self._latest = question
                    return None
            self._latest = question
        if not question.known:
            question.take_apart(self._program)
        if question.place < 0:
            return None
        try:
            module = function.__closure__[question.place].cell_contents  # type: ignore[index]
        except ValueError:  # nothing is there yet
            return None
        return question.condition if module is question.module else question.about(module)

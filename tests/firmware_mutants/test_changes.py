"""Mutants of a small firmware."""

from __future__ import annotations

import ast

import pytest

from tests.firmware_mutants.changes import Mutant, mutants

SOURCE = '''
RRDY, SDIR = 8, 64

class Emulator:
    def serve(self):
        """Not a statement."""
        self.i2c.I2CMDR.IRS = 1
        if self.i2c.I2CSTR.all & RRDY:
            self.count = 6
        return 0

    def other(self):
        pass
'''


def made(kind: str) -> list[str]:
    found = [one for one in mutants("small", SOURCE, ("serve",)) if one.kind.startswith(kind)]
    return [one.after or one.kind for one in found]


def test_each_statement_is_deleted_delayed_and_moved_past_its_neighbour():
    assert len(made("deleted")) == len(made("20 ")) == len(made("300 ")) == 4
    assert made("moved") == ["moved past if self.i2c.I2CSTR.all & RRDY:", "moved past return 0"]


def test_each_constant_flag_and_field_is_exchanged():
    assert made("exchanged") == [
        "self.i2c.I2CMDR.STB = 1",
        "self.i2c.I2CMDR.IRS = 0",
        "if self.i2c.I2CSTR.all & SDIR:",
        "self.count = 4",
        "return 1",
    ]


def small(text: str) -> Mutant:
    (found,) = (one for one in mutants("small", SOURCE, ("serve",)) if one.text == f"serve: {text}")
    return found


@pytest.mark.parametrize(
    ("text", "body"),
    [
        ("deleted: self.count = 6", ["if self.i2c.I2CSTR.all & RRDY:", "    pass"]),
        ("20 cycles late: return 0", ["self.dsp.compute(20)", "return 0"]),
        ("300 cycles late: self.i2c.I2CMDR.IRS = 1", ["self.dsp.compute(300)", "self.i2c.I2CMDR.IRS = 1"]),
        (
            "moved past return 0: if self.i2c.I2CSTR.all & RRDY:",
            ["return 0", "if self.i2c.I2CSTR.all & RRDY:", "    self.count = 6"],
        ),
        ("exchanged: return 0 --> return 1", ["return 1"]),
    ],
)
def test_only_the_statement_itself_is_changed(text: str, body: list[str]):
    before, after = (ast.unparse(tree).splitlines() for tree in (ast.parse(SOURCE), small(text).tree()))
    assert "\n".join(f"        {line}" for line in body) in "\n".join(after)
    changed = [line for line in before if line not in after] + [line for line in after if line not in before]
    assert len(changed) <= 2


def test_every_mutant_is_a_different_program_that_compiles():
    found = list(mutants("small", SOURCE, ("serve",)))
    texts = [ast.unparse(one.tree()) for one in found]
    assert len(set(texts)) == len(texts) and ast.unparse(ast.parse(SOURCE)) not in texts
    for one in found:
        compile(one.tree(), "small", "exec")

"""The changes that are made of a firmware's statements, and that what catches them can fail."""

from __future__ import annotations

import ast

import pytest

from tests.firmware_mutants.argued import ARGUMENTS
from tests.firmware_mutants.changes import mutants
from tests.firmware_mutants.trials import RUNS, Run, all_mutants, tried, usual_figures

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


def test_every_mutant_is_another_program_that_compiles():
    found = list(mutants("small", SOURCE, ("serve",)))
    texts = [ast.unparse(one.tree) for one in found]
    assert len(set(texts)) == len(texts) and ast.unparse(ast.parse(SOURCE)) not in texts
    for one in found:
        compile(one.tree, "small", "exec")


@pytest.mark.parametrize("firmware", RUNS)
def test_unchanged_firmware_breaks_nothing(firmware: str):
    assert usual_figures(firmware, RUNS[firmware][0])


@pytest.mark.parametrize(
    ("text", "by", "how"),
    [
        ("slave_config: deleted: i2c.I2COAR.all = address", "reaction", "broken"),
        ("batch_read: 300 cycles late: i2c.I2CDXR.all = next(buffer)", "reaction", "broken"),
        ("start_pie: deleted: dsp.eint()", "data age", "broken"),
        ("batch_read: 20 cycles late: i2c.I2CDXR.all = next(buffer)", "reaction", "moved"),
        ("start_pin: moved past dsp.clear_pin(pin): port = 'ABC'[pin // 32]", "", ""),
    ],
)
def test_a_mutant_is_caught_by_the_budget_that_it_is_about(text: str, by: str, how: str, monkeypatch):
    (mutant,) = (one for one in all_mutants("imu_hil") if str(one).endswith(text))
    monkeypatch.setitem(RUNS, "imu_hil", (Run("imu_hil", "0.14"),))
    trial = tried("imu_hil", mutant)
    assert trial.how == how and (how != "broken" or trial.by) and (how == "broken" or trial.by == by)


def test_every_argument_is_about_some_mutant():
    found = [one for firmware in RUNS for one in all_mutants(firmware)]
    for one in ARGUMENTS:
        assert any(one.function == each.function and one.before in each.before for each in found), one

"""Trials of mutants: the right budget catches each, and mutants without effect pass."""

from __future__ import annotations

import pytest

from periph_sim.records.lint import lint
from periph_sim.scene.case.load import load
from tests.firmware_mutants.__main__ import main
from tests.firmware_mutants.argued import ARGUMENTS, WITHOUT_EFFECT, argument_of, means
from tests.firmware_mutants.changes import Mutant
from tests.firmware_mutants.survivors import KNOWN
from tests.firmware_mutants.tally import Tally
from tests.firmware_mutants.trials import (
    BROKEN,
    ENDED,
    MOVED,
    RUNS,
    Run,
    Trial,
    all_mutants,
    tried,
    usual_figures,
)
from tests.records.scenes import recorded
from tests.scene.runs import TIMING

SHORT = {file: runs[:1] for file, runs in RUNS.items()} | {"imu_hil_robust": RUNS["imu_hil_robust"][2:3]}


def the_mutant(text: str) -> Mutant:
    (found,) = (one for file in RUNS for one in all_mutants(file) if f"{one.file} {one.text}" == text)
    return found


@pytest.mark.parametrize("run", {run: None for runs in RUNS.values() for run in runs}, ids=str)
def test_the_unchanged_firmware_breaks_nothing(run: Run):
    assert usual_figures(run).budgets


@pytest.mark.parametrize(
    ("text", "by", "how"),
    [
        ("imu_hil slave_config: deleted: i2c.I2COAR.all = address", "nacked rounds", BROKEN),
        ("imu_hil slave_config: exchanged: i2c.I2CMDR.IRS = 0 --> i2c.I2CMDR.IRS = 1", "module off", BROKEN),
        ("imu_hil batch_read: 300 cycles late: i2c.I2CDXR.all = next(buffer)", "reaction", BROKEN),
        ("imu_hil batch_read: 20 cycles late: i2c.I2CDXR.all = next(buffer)", "reaction", MOVED),
        ("imu_hil batch_read: 20 cycles late: i2c.I2CSTR.SCD = 1", "CPU load", MOVED),
        ("imu_hil batch_read: exchanged: i2c.I2CMDR.TRX = 1 --> i2c.I2CMDR.TRX = 0", "", ""),
        ("startup start_pie: deleted: dsp.eint()", "SCI FIFO high-water", BROKEN),
        ("startup start_i2c: 20 cycles late: i2c.I2CCLKH.all = 5", "CPU load", MOVED),
        ("startup start_i2c: exchanged: i2c.I2CCLKH.all = 5 --> i2c.I2CCLKH.all = 4", "", ""),
        ("imu_hil_robust look_at_line: deleted: sci.SCICTL1.SWRESET = 0", "data age", BROKEN),
        ("imu_hil_robust look_at_line: 20 cycles late: sci.SCICTL1.SWRESET = 0", "CPU load", MOVED),
    ],
)
def test_a_mutant_is_caught_by_the_budget_of_its_effect(text: str, by: str, how: str, monkeypatch):
    mutant = the_mutant(text)
    monkeypatch.setitem(RUNS, mutant.file, SHORT[mutant.file])
    trial = tried(mutant)
    assert (trial.by, trial.how) == (by, how)


def test_a_mutant_that_ends_the_run_is_reported_with_its_error():
    trial = tried(the_mutant("imu_hil sci_received: deleted: sci, pie = (self.sci, self.pie)"))
    assert trial.how == ENDED and "NameError" in trial.by


# Arguments ----------------------------------------------------------------------------


def test_every_argument_names_existing_mutants_and_each_mutant_has_at_most_one():
    found = [one for file in RUNS for one in all_mutants(file)]
    for one in ARGUMENTS:
        for text in one.mutants:
            assert any(means(text, mutant) for mutant in found), text
    for mutant in found:
        assert sum(means(text, mutant) for one in ARGUMENTS for text in one.mutants) <= 1, mutant


def test_lint_reports_the_writes_that_are_argued_to_be_without_effect():
    findings = lint(recorded(load(TIMING / "imu_hil.toml", []), "0.012"))
    argued = {
        f"{mutant.function}:{mutant.line}"
        for mutant in all_mutants("imu_hil")
        if (argument := argument_of(mutant)) and argument.lint == WITHOUT_EFFECT
    }
    assert argued == {finding.place for finding in findings if finding.lint == WITHOUT_EFFECT}


def test_an_argued_mutant_that_is_caught_is_refuted():
    argued = the_mutant("startup start_i2c: exchanged: i2c.I2CCLKH.all = 5 --> i2c.I2CCLKH.all = 4")
    other = the_mutant("startup start_pie: deleted: dsp.eint()")
    tally = Tally([Trial(argued, "case", "stretch", BROKEN), Trial(other)])
    assert [trial.mutant for trial in tally.refuted] == [argued]
    assert [trial.mutant for trial in tally.survivors] == [other]
    assert tally.share == 50
    assert Tally([Trial(argued), Trial(other, "case", "data age", BROKEN)]).share == 100


# Exit status -----------------------------------------------------------------------------


def test_known_survivors_exist_and_none_is_argued():
    found = {one.text: one for file in RUNS for one in all_mutants(file)}
    assert not [text for text in KNOWN if text not in found or argument_of(found[text])]


@pytest.mark.parametrize(
    ("survives", "argued_is_caught", "status", "message"),
    [
        ("", False, 0, ""),
        ("run: moved past self.start_timer(self.round_timer", False, 0, "\nsurvived: imu_hil_robust.py"),
        ("serve: deleted: ", False, 1, "\nsurvived, not listed in survivors.py: imu_hil_robust.py"),
        ("", True, 1, "\nargued to have no effect, but caught by data age: imu_hil_robust.py"),
    ],
    ids=["all caught", "one survives that is known to", "another one survives", "an argued one is caught"],
)
def test_the_status_is_1_for_an_unknown_survivor_or_a_refuted_argument(
    survives: str, argued_is_caught: bool, status: int, message: str, monkeypatch, capsys
):
    spared = next((one for one in all_mutants("imu_hil_robust") if survives and one.text.startswith(survives)), None)

    def trial(mutant: Mutant) -> Trial:
        passes = mutant == spared or (argument_of(mutant) and not argued_is_caught)
        return Trial(mutant) if passes else Trial(mutant, "case", "data age", BROKEN)

    monkeypatch.setattr("tests.firmware_mutants.__main__.tried", trial)
    assert main(["imu_hil_robust"]) == status
    said = capsys.readouterr().out
    assert (message in said) if message else ("survived:" not in said and "caught by" not in said)

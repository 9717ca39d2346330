"""Real mutants, their detection by shipped cases, and their section of the page."""

from __future__ import annotations

import pytest

from periph_sim.scene.case.load import load
from tests.firmware_mutants import real
from tests.firmware_mutants.real import (
    BUDGET,
    FIGURE,
    HEAD,
    NEITHER,
    SECTION,
    Judged,
    Sample,
    section,
    section_of,
    with_section,
)
from tests.firmware_mutants.reality import (
    BENCHES,
    BYTES,
    DEADLINE,
    ENDS,
    ORDER,
    Behaviour,
    Difference,
    difference,
    phases,
)
from tests.firmware_mutants.shipped import SHIPPED, failing
from tests.firmware_mutants.test_trials import the_mutant
from tests.firmware_mutants.trials import mutated, unchanged
from tests.scene.runs import TIMING

WAITS = "imu_hil batch_read: deleted: dsp.spin(lambda: i2c.I2CSTR.SDIR == 1)"


# Real or not -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("imu_hil sci_received: deleted: pie.PIEACK.all = 256", DEADLINE),
        ("imu_hil sci_received: deleted: self.frame_waits = True", BYTES),
        ("imu_hil sci_received: deleted: sci, pie = (self.sci, self.pie)", ENDS),
        ("imu_hil batch_read: deleted: i2c.I2CCNT.all = 1", None),
        ("imu_hil batch_read: 20 cycles late: i2c.I2CDXR.all = next(buffer)", None),
    ],
)
def test_a_mutant_is_real_if_bytes_or_deadlines_change(text: str, kind: str | None):
    found = difference(the_mutant(text), seed=1, count=3)
    assert (found.kind if found else None) == kind


def test_deadlines_are_compared_before_bytes_and_bytes_before_order():
    usual = Behaviour(["0x68 R 01"], [(3, "STOP"), (1, "START")], frozenset({"age"}))
    assert Behaviour(["0x68 R 01"], [(1, "START"), (9, "STOP")], frozenset()).difference(usual) == ("", "")
    assert Behaviour(["0x68 R 02"], usual.order, frozenset({"age"})).difference(usual)[0] == BYTES
    assert Behaviour([], usual.order, frozenset()).difference(usual) == (BYTES, "0 transfers, not 1")
    late = Behaviour(["0x68 R 01"], [(4, "START"), (3, "STOP")], frozenset({"age"}))
    assert late.difference(usual) == (ORDER, "STOP, not START")
    assert Behaviour(["0x68 R 02"], [], frozenset({"age", "SCL"})).difference(usual) == (DEADLINE, "SCL")


def test_a_seed_draws_phases_of_each_bench_and_the_same_ones_again():
    drawn = phases("imu_hil_robust", 5, 24)
    assert drawn == phases.__wrapped__("imu_hil_robust", 5, 24) != phases("imu_hil_robust", 6, 24)
    assert len({phase.changes for phase in drawn}) == 24
    assert {phase.run for phase in drawn} == {run for run, _ in BENCHES["imu_hil_robust"]}


# Budgets as shipped ----------------------------------------------------------------------


def test_shipped_cases_are_those_that_the_firmware_passes():
    for file, names in SHIPPED.items():
        own = {
            path.stem
            for path in TIMING.glob("imu_hil*.toml")
            if (case := load(path, [])).unit["dsp"].firmware == file and not case.breaks
        }
        assert own <= set(names)


@pytest.mark.parametrize(
    ("case", "text", "by"),
    [
        ("imu_hil_drift", WAITS, "imu_hil_drift: wrong bytes"),
        ("imu_hil_drift", "", ""),
    ],
    ids=["a budget is broken", "the unchanged firmware"],
)
def test_a_case_with_a_mutant_names_the_first_budget_that_is_broken(case: str, text: str, by: str):
    module = mutated("imu_hil", the_mutant(text)) if text else unchanged("imu_hil")
    assert failing(case, module, "0.1") == by


def test_figures_of_other_phases_detect_a_mutant_that_no_budget_detects(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(real, "BASELINES", 2)
    late = the_mutant("imu_hil batch_read: 20 cycles late: i2c.I2CDXR.all = next(buffer)")
    assert real.figure_moved(late, 1).startswith("imu_hil: ")
    assert (
        real.figure_moved(the_mutant("imu_hil batch_read: exchanged: i2c.I2CCNT.all = 1 --> i2c.I2CCNT.all = 0"), 1)
        == ""
    )


# A sample and its section ------------------------------------------------------------------


@pytest.fixture
def sample(monkeypatch: pytest.MonkeyPatch) -> Sample:
    """A sample of four mutants, one of them not real, and the others detected in different ways."""
    came = iter([(BUDGET, "imu_hil: stretch"), (FIGURE, "imu_hil: CPU load"), (NEITHER, ""), None])

    def judged(mutant: real.Mutant, seed: int) -> Judged | None:
        how = next(came)
        return how and Judged(mutant, Difference(BYTES, "01, not 02", 7), how[1], how[0], rare=3)

    monkeypatch.setattr(real, "judged", judged)
    return Sample(11, 4)


def test_a_sample_counts_how_real_mutants_are_detected(sample: Sample):
    assert str(sample) == "seed 11: 4 drawn, 3 real: 1 budget, 1 figure, 1 neither; budgets 33.3 %"


def test_the_section_lists_what_no_budget_detects_with_the_reason(sample: Sample):
    text = section([sample])
    assert text.startswith(SECTION + HEAD + "| 11 | 4 | 3 | 1 (33 %) | 1 | 1 |\n")
    assert text.count("\n* `") == 2
    assert "imu_hil: CPU load is another figure; bytes (01, not 02)." in text
    assert "it differs in 3 of 200 phases only, and in none of the 24; bytes (01, not 02)." in text


def test_the_section_replaces_the_one_of_the_page_and_nothing_else(sample: Sample):
    new = section([sample])
    assert with_section("# Page\n\ntext\n\n## Next\n", new) == f"# Page\n\ntext\n\n{new}\n## Next\n"
    assert with_section(f"# Page\n\n{SECTION}old\n\n## Next\n", new) == f"# Page\n\n{new}\n## Next\n"
    assert with_section(f"# Page\n\n{new}", new) == f"# Page\n\n{new}"
    assert section_of(f"# Page\n\n{new}\n## Next\n") == section_of(f"# Page\n\n{new}") == new
    assert section_of("# Page\n\n## Next\n") == ""


@pytest.mark.parametrize(("share", "status"), [(80, 0), (79, 1)])
def test_the_status_is_1_below_80_percent(share: int, status: int, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(Sample, "__init__", lambda self, seed, *_: vars(self).update(seed=seed, drawn=[], real=[]))
    monkeypatch.setattr(Sample, "share", share)
    assert real.main(["--seed", "5"]) == status

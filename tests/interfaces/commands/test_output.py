"""Output of `run`: a table within 80 columns, a legend for the words that occur, and details with -v."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.interfaces.commands.result_text import budget_table, legend, rounded, show
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from periph_sim.timing.verdict import FAIL, NOT_JUDGED, PASS, Verdict, Word
from tests.interfaces.commands.conftest import Run
from tests.scene.runs import TIMING

CASES = sorted(path.stem for path in TIMING.glob("*.toml"))


def verdict(name: str, word: Word) -> Verdict:
    value = 2.0 if word == FAIL else 0.5
    return Verdict(name, "response", "us", value, 1.0, 1.0 - value, 7, word, 0.25)


def shown(budgets: list[Verdict], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> list[str]:
    monkeypatch.setenv("COLUMNS", "80")
    budget_table(budgets)
    return capsys.readouterr().out.splitlines()


@pytest.mark.parametrize("name", CASES)
def test_the_table_and_legend_of_every_shipped_case_fit_80_columns(name: str, monkeypatch, capsys):
    """Two rounds are run, and the counts of occurrences are those of the baseline of the whole run."""
    case = load(TIMING / f"{name}.toml")
    result = Scene(case).run(min(Fraction(1, 20), Fraction(case.duration)))
    whole = json.loads((TIMING / "baselines" / f"{name}.json").read_text(encoding="utf-8"))["budgets"]
    for budget in result.budgets:
        budget.count = whole[budget.name]["count"]
    lines = shown(result.budgets, monkeypatch, capsys)
    assert len(lines) == 4 + len(result.budgets), "a row takes two lines"
    assert max(map(len, lines)) <= 80 and "…" not in "".join(lines)
    broken = sum(budget.broken and budget.worst is not None for budget in result.budgets)
    assert all(len(line) <= 80 for line in legend(result.budgets)[broken:])


def test_a_long_name_takes_two_lines_and_loses_no_word(monkeypatch, capsys):
    name = "from the last bit of the frame to the first pulse of the answer on the other bus"
    one = verdict(name, PASS)
    assert set(name.split()) <= set(" ".join(shown([one], monkeypatch, capsys)).split())


held = verdict("held", PASS)
broken = verdict("broken", FAIL)
scarce = verdict("scarce", NOT_JUDGED)

SEEN = "count: occurrences; seen: held in this run, other timings are not covered"


@pytest.mark.parametrize(
    ("budgets", "lines"),
    [
        ([], []),
        ([held], [SEEN]),
        ([broken], ["broken: 2.000 us is over its limit of 1.000 us, at 0.250000 s", "count: occurrences"]),
        ([scarce], ["count: occurrences", "not judged: too little was measured; no pass"]),
        ([held, scarce], [SEEN, "not judged: too little was measured; no pass"]),
    ],
)
def test_the_legend_explains_only_the_words_of_this_table(budgets: list[Verdict], lines: list[str]):
    assert legend(budgets) == lines


def test_assumptions_are_counted_and_listed_with_verbose(periph_sim: Run):
    short = ("run", str(TIMING / "wrong_order.toml"), "--seconds", "0.01")
    names = periph_sim(*short, "--json").json_object["unknowns"]
    assert periph_sim(*short).out.endswith(f"\nassumes {len(names)} undocumented behaviours (-v lists them)\n")
    option = ("--set", "unit.dsp.options.i2c.noise_filter_cycles=2")
    report = periph_sim(*short, "-v", *option).out.splitlines()
    at = report.index(f"assumes {len(names)} undocumented behaviours; `regs --options` lists the questions:")
    assert [line.split()[0] for line in report[at + 1 :]] == names
    assert "  dsp.i2c.noise_filter_cycles = 2; the default is 1" in report
    assert "  dsp.i2c.aas_sdir_point = fall8, the default" in report


def test_a_run_without_assumptions_does_not_mention_them(periph_sim: Run, desk: Path):
    assert "undocumented" not in periph_sim("run", "small.toml", "-v").out


def test_assumptions_of_a_chip_on_the_bus_have_its_name(periph_sim: Run):
    reserved = ("--set", "chip.gyroscope.registers.DLPF_FS=0")
    report = periph_sim("run", str(TIMING / "imu_chips.toml"), "--seconds", "0.01", "--verbose", *reserved).out
    assert "\n  gyroscope.fs_sel_other = as_3, the default\n" in report


def test_verbose_shows_the_rounded_number_of_skipped_polls(periph_sim: Run):
    short = ("run", str(TIMING / "wrong_order.toml"), "--seconds", "0.01")
    exact = periph_sim(*short, "--json").json_object["counts"]["polls_skipped"]
    assert 1_000 <= exact < 1_000_000
    assert "polls" not in periph_sim(*short).out
    assert f"\nskipped {exact / 1000:.1f} k polls\n" in periph_sim(*short, "-v").out


@pytest.mark.parametrize(
    ("count", "text"), [(142_688_792, "142.7 M"), (161_830, "161.8 k"), (1000, "1.0 k"), (999, "999")]
)
def test_a_large_count_is_rounded(count: int, text: str):
    assert rounded(count) == text


@pytest.mark.parametrize(("word", "code"), [(PASS, 32), (FAIL, 31), (NOT_JUDGED, 33)])
def test_the_headline_has_the_colour_of_its_verdict_on_a_terminal_only(word: Word, code: int, monkeypatch, capsys):
    for name in ("NO_COLOR", "TERM", "TTY_COMPATIBLE", "FORCE_COLOR"):
        monkeypatch.delenv(name, raising=False)
    case = load(TIMING / "imu_hil.toml")
    result = Scene(case).run(Fraction(1, 1000))
    result.verdict = word
    show(result, case)
    plain = capsys.readouterr().out
    monkeypatch.setenv("FORCE_COLOR", "1")
    show(result, case)
    styled = capsys.readouterr().out
    assert "\x1b" not in plain
    assert styled.startswith(f"\x1b[{code}m{plain.splitlines()[0]}\x1b[0m\n")

"""Cases compared with their baselines: equal, changed, missing, written, and budgets that must break."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from periph_sim.interfaces.reports.baselines.check import CaseCheck, case_files, check, judge
from periph_sim.interfaces.reports.baselines.compare import compare
from periph_sim.interfaces.reports.baselines.files import BadCheck, Baseline, text_of
from periph_sim.interfaces.reports.baselines.outcome import RejectedCase, run_again
from periph_sim.scene.project import baseline_path
from tests.interfaces.reports.baselines.desk import change, put


def texts(one: CaseCheck) -> list[str]:
    return [finding.text for finding in one.findings]


def test_an_equal_run_passes_and_its_figures_are_the_same_bytes(cases: Path):
    before = baseline_path(cases / "small.toml").read_bytes()
    (one,) = check([cases], jobs=1)
    assert (one.state, one.findings, one.changes) == ("equal", [], [])
    assert one.outcome.values == [None] * 3
    (again,) = check([cases], jobs=1, update=True)
    assert (again.state, again.diff) == ("equal", "")
    assert baseline_path(cases / "small.toml").read_bytes() == before == text_of(again.outcome.figures).encode()


def test_slower_firmware_changes_the_figures_and_the_first_moved_event_is_named(cases: Path):
    """I2CDXR is written 1490 cycles before the address's ACK ends; the write is due 750 cycles after that end."""
    put(cases, wait=3000)
    (one,) = check([cases], jobs=1)
    assert one.state == "changed"
    assert "response worst 750 -> 1543 cycles: I2C-A.I2CDXR written by dsp 3000 cycles later" in texts(one)
    assert {change.budget for change in one.changes} == {"response", None}  # and no other budget's figures
    least = next(change for change in one.changes if change.figure == "least")
    assert least.before == 15000 and least.why == ""


@pytest.mark.parametrize("tolerance", [0, 1])
def test_a_moved_access_is_reported_with_its_line_if_every_budget_holds(cases: Path, tolerance: int):
    """The firmware computes 20 cycles more before each I2CDXR write, far from the deadline and above the tolerance."""
    put(cases, wait=20)
    (one,) = check([cases], jobs=1, tolerance=tolerance)
    assert one.state == "changed" and not one.outcome.broken
    (moved,) = [text for text in texts(one) if "I2C-A.I2CDXR written by dsp 20 cycles later" in text]
    assert "holds, but an access moved: " in moved and "[" in moved and ".py:" in moved


def test_a_moved_access_is_reported_if_no_figure_and_no_count_changes(cases: Path):
    """`TRX = 1` and the write of I2CCNT after it are swapped, which takes the same time as before."""
    firmware = cases / "small_firmware.py"
    text = firmware.read_text(encoding="utf-8")
    first, second = "        i2c.I2CMDR.TRX = 1\n", "        i2c.I2CCNT.all = self.settings.count\n"
    assert first + second in text
    firmware.write_text(text.replace(first + second, second + first), encoding="utf-8")
    (one,) = check([cases], jobs=1)
    assert not [change for change in one.changes if change.budget is None]
    assert one.state == "changed" and not one.outcome.broken
    (moved,) = texts(one)
    assert "holds, but an access moved: I2C-A.I2C" in moved and moved.endswith("[small_firmware.py:105 (batch_read)]")


def test_a_second_run_is_made_only_if_something_changed(cases: Path, monkeypatch: pytest.MonkeyPatch):
    """The second run finds the chains. It is omitted if figures and digest of event times equal the baseline's."""
    second: list[Path] = []

    def run(path: Path, *rest: Any) -> Any:
        second.append(path)
        return run_again(path, *rest)

    monkeypatch.setattr(sys.modules[check.__module__], "run_again", run)
    path = baseline_path(cases / "small.toml")
    before = path.read_text(encoding="utf-8")
    (one,) = check([cases], jobs=1)
    assert text_of(one.outcome.figures) == before
    check([cases], jobs=1, update=True)
    assert second == []
    path.write_text(before.replace('"digest": "', '"digest": "x'), encoding="utf-8")
    (one,) = check([cases], jobs=1)
    assert one.state == "equal" and text_of(one.outcome.figures) == before
    tree = json.loads(before)
    del tree["digest"]  # as an earlier version wrote it
    path.write_text(json.dumps(tree), encoding="utf-8")
    assert check([cases], jobs=1)[0].state == "equal"
    assert len(second) == 2
    check([cases], jobs=1, update=True)
    assert len(second) == 3 and path.read_text(encoding="utf-8") == before


def test_a_move_within_the_tolerance_is_no_change(cases: Path):
    put(cases, wait=20)
    (one,) = check([cases], jobs=1, tolerance=25)
    assert (one.state, texts(one)) == ("equal", [])
    assert one.changes and all(change.note for change in one.changes)


def test_a_new_wrong_byte_is_reported_with_the_bytes_read(cases: Path):
    put(cases, sdir_wait=False)
    (one,) = check([cases], jobs=1)
    read_ = "gyroscope read 12 13 14 15 16 00 where 11 12 13 14 15 16 was expected"
    assert f"wrong bytes worst 0 -> 12 bytes: {read_}" in texts(one)
    assert texts(one)[0] == "wrong bytes breaks: 12 bytes is over its limit of 0 bytes, at 0.005195 s"


@pytest.mark.parametrize(
    ("off", "tolerance", "passes"), [(1, 0, False), (100, 4, False), (100, 5, True), (-100, 5, True)]
)
def test_times_may_differ_by_the_tolerance(cases: Path, off: int, tolerance: int, passes: bool):
    """A cycle is 20 ticks."""
    change(baseline_path(cases / "small.toml"), worst=15000 + off, worst_at=1)
    (one,) = check([cases], jobs=1, tolerance=tolerance) if tolerance else check([cases], jobs=1)
    assert one.passed == passes
    assert ("response worst at" in "".join(texts(one))) == (tolerance == 0)


def test_every_changed_figure_of_a_baseline_is_found(cases: Path):
    """Each number and text of the file is changed in turn, except chains and the event digest, which only explain."""
    path = baseline_path(cases / "small.toml")
    good = path.read_text(encoding="utf-8")
    (one,) = check([cases], jobs=1)
    places = [
        place
        for place in leaves(json.loads(good))
        if not {"chain", "chain_of", "schema_version", "digest"} & set(place)
    ]
    assert len(places) == 3 * 7 + 10 + 6
    for place in places:
        tree = json.loads(good)
        table = tree
        for key in place[:-1]:
            table = table[key]
        was = table[place[-1]]
        more = {str: "x", int: 1, list: ["x"]}
        table[place[-1]] = 7 if was is None else was + more[type(was)]
        assert compare(Baseline.model_validate(tree), one.outcome.figures), place


def leaves(tree: dict[str, Any], *above: str) -> list[tuple[str, ...]]:
    found = [leaves(value, *above, key) if isinstance(value, dict) else [(*above, key)] for key, value in tree.items()]
    return [place for places in found for place in places]


def test_the_start_time_of_the_run_changes_no_figure_and_no_chain(cases: Path):
    put(cases, breaks='start = "30 d"\n')
    assert check([cases], jobs=1)[0].passed
    assert check([cases], jobs=1, update=True)[0].state == "equal"


def test_a_change_can_be_tried_without_touching_the_file(cases: Path):
    (one,) = check([cases], jobs=1, changes=["unit.dsp.settings.model_cost=400 us"])
    assert "model worst 37500 -> 60000 cycles: model ended by dsp 22500 cycles later" in texts(one)
    assert {finding.budget for finding in one.findings} == {"model"}


def test_a_missing_baseline_is_reported_until_it_is_written(cases: Path):
    path = baseline_path(cases / "small.toml")
    path.unlink()
    (one,) = check([cases], jobs=1)
    assert (one.state, texts(one)) == ("missing", [f"it has no baseline {path}; write one with --update-baseline"])
    assert not path.exists()
    assert check([cases], jobs=1, update=True)[0].passed
    assert check([cases], jobs=1)[0].passed


def test_an_update_shows_each_changed_line_between_its_neighbours(cases: Path):
    path = baseline_path(cases / "small.toml")
    lines = path.read_text(encoding="utf-8").splitlines()
    place = lines.index('      "count": 2,')
    other = [*lines[:place], '      "count": 3,', *lines[place + 1 :]]
    path.write_text("\n".join(other), encoding="utf-8")
    (one,) = check([cases], jobs=1, update=True)
    head = ["--- cases/baselines/small.json", "+++ cases/baselines/small.json", f"@@ -{place},3 +{place},3 @@"]
    changed = ['-      "count": 3,', '+      "count": 2,']
    assert one.diff.splitlines() == [*head, f" {lines[place - 1]}", *changed, f" {lines[place + 1]}"]
    path.unlink()
    (one,) = check([cases], jobs=1, update=True)
    whole = f"@@ -0,0 +1,{len(lines)} @@"
    assert one.diff.splitlines() == ["--- nothing", head[1], whole, *(f"+{line}" for line in lines)]
    assert one.changes == []


def test_an_update_shows_what_it_changed(cases: Path):
    put(cases, wait=3000)
    (one,) = check([cases], jobs=1, update=True)
    assert one.state == "written" and one.passed
    assert "response worst 750 -> 1543 cycles: I2C-A.I2CDXR written by dsp 3000 cycles later" in map(str, one.changes)
    assert check([cases], jobs=1)[0].passed


BREAKS = [
    ("", ["wrong bytes breaks: 12 bytes is over its limit of 0 bytes, at 0.005195 s"]),
    ('breaks = ["wrong bytes"]\n', []),
    (
        'breaks = ["wrong bytes", "model"]\n',
        ["model holds, but is listed in breaks; remove it there if the bug is fixed"],
    ),
    (
        'breaks = ["model"]\n',
        [
            "wrong bytes breaks: 12 bytes is over its limit of 0 bytes, at 0.005195 s",
            "model holds, but is listed in breaks; remove it there if the bug is fixed",
        ],
    ),
]


@pytest.mark.parametrize(("breaks", "found"), BREAKS)
def test_a_case_passes_only_if_exactly_its_known_bugs_break(cases: Path, breaks: str, found: list[str]):
    """Only budgets that break and must not break are explained."""
    put(cases, sdir_wait=False, breaks=breaks)
    for update in (True, False):
        (one,) = check([cases], jobs=1, update=update)
        assert texts(one) == found and one.outcome.broken == ["wrong bytes"]
        assert [*one.causes] == ([] if "wrong bytes" in breaks else ["wrong bytes"])


def test_a_budget_that_must_break_but_measures_nothing_is_not_judged(cases: Path):
    path = put(cases, breaks='breaks = ["model"]\n')
    path.write_text(path.read_text().replace("span:model", "span:modle"), encoding="utf-8")
    (one,) = check([cases], jobs=1)
    assert (one.outcome.broken, one.outcome.not_passed, one.passed) == ([], ["model"], False)
    (verdict,) = (verdict for verdict in one.outcome.verdicts if not verdict.passed)
    assert verdict.found and texts(one)[0] == f"model is not judged: {verdict.found}"
    assert "model worst 37500 cycles -> nothing measured" in texts(one)
    one.outcome.result.budgets = [replace(verdict, found="")]
    assert judge(one)[0].text == "model is not judged: nothing was measured by 'span:modle'"


def test_firmware_that_waits_for_ever_fails_though_no_budget_breaks(cases: Path):
    path = put(cases)
    text = path.read_text(encoding="utf-8").replace("[controller]\n", "[controller]\nrounds = 1\n")
    path.write_text(text.partition("[[budget]]")[0], encoding="utf-8")
    assert check([path], jobs=1, update=True)[0].passed  # an agent may wait for a request for ever
    text = text.partition("[controller]")[0]
    path.write_text(text, encoding="utf-8")
    (one,) = check([path], jobs=1, update=True)
    assert len(one.findings) == 1 and "waits for" in one.findings[0].text and "for ever" in one.findings[0].text


@pytest.mark.parametrize("jobs", [2, 3])
def test_the_number_of_processes_changes_neither_results_nor_order(cases: Path, jobs: int):
    put(cases, "a", wait=3000)
    put(cases, "z", sdir_wait=False)
    alone = check([cases], jobs=1)
    together = check([cases], jobs=jobs)
    assert [one.outcome.figures.case for one in together] == ["a", "small", "z"]
    for one in (*alone, *together):
        one.outcome.result.wall_s = 0
    assert together == alone


def test_a_process_that_dies_is_reported_with_its_case(cases: Path):
    """The check runs in a process of its own, so that the exit of the firmware cannot end the test runner."""
    bad = put(cases, "bad", does="__import__('os')._exit(1)")
    command = [sys.executable, "-m", "periph_sim", "check", str(cases), "--jobs", "2"]
    came = subprocess.run(command, capture_output=True, text=True, check=False)
    assert came.returncode == 2
    assert f"{bad}: its process died before it finished; " in came.stdout
    assert "small " in came.stdout  # the other case was checked


def test_cases_of_subfolders_are_found_among_other_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The folder is a repository with other TOML files and a virtual environment (finding 37)."""
    monkeypatch.chdir(tmp_path)
    Path("pyproject.toml").write_text('[project]\nname = "theirs"\n[tool.ruff]\n', encoding="utf-8")
    Path("poetry.toml").write_bytes(b"\xff not even text")
    for folder in ("timing", "timing/slow", ".hidden", "env/lib"):
        Path(folder).mkdir(parents=True)
        put(Path(folder), folder.replace("/", "_").strip("."))
    Path("env/pyvenv.cfg").touch()
    assert case_files([Path(".")]) == [Path("timing/timing.toml"), Path("timing/slow/timing_slow.toml")]


def test_a_case_that_is_given_by_several_paths_is_checked_once(cases: Path):
    case = cases / "small.toml"
    (cases / "sub").mkdir()
    (cases / "link").symlink_to(cases.absolute())
    others = [cases / "sub" / ".." / "small.toml", cases / "link" / "small.toml", case.absolute(), cases]
    assert case_files([case, *others]) == [case]
    assert case_files([*others, case]) == others[:1]
    (cases / "other.toml").symlink_to(case.absolute())  # it has a baseline of its own
    assert case_files([case, cases / "other.toml"]) == [case, cases / "other.toml"]


def test_a_case_file_with_a_toml_error_is_not_skipped(cases: Path):
    (cases / "bad.toml").write_text("[unit.dsp\nfirmware = ", encoding="utf-8")
    assert cases / "bad.toml" in case_files([cases])


def test_a_case_that_cannot_run_is_reported_and_the_others_are_checked(cases: Path):
    bad = put(cases, "bad", does="raise ValueError('boom')")
    stale = put(cases, "stale")
    baseline_path(stale).write_text("{", encoding="utf-8")
    refused: list[RejectedCase] = []
    (one,) = check([cases], jobs=1, on_refused=refused.append)
    assert one.passed and one.outcome.path == cases / "small.toml"
    assert {case.path for case in refused} == {bad, stale}


def test_two_budgets_of_one_name_are_refused(cases: Path):
    path = put(cases)
    path.write_text(path.read_text().replace('name = "model"', 'name = "response"'), encoding="utf-8")
    with pytest.raises(BadCheck, match=r"line 30: budget.2.name: there are two budgets 'response'; .* rename one"):
        check([path], jobs=1)


@pytest.mark.parametrize(
    ("path", "sentence"),
    [
        ("nowhere", "nowhere: there is no such file or folder; give case files, or folders of them"),
        (
            "empty",
            "empty: it contains no case; expected .toml files with a [unit.NAME], [controller] or [[budget]] table",
        ),
    ],
)
def test_a_path_without_a_case_is_an_error(cases: Path, path: str, sentence: str):
    Path("empty").mkdir()
    with pytest.raises(BadCheck) as caught:
        check([Path(path)])
    assert str(caught.value) == sentence

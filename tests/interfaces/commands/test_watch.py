"""`periph-sim watch`: each change of the case's files starts a run. The tests edit the files while `watch` sleeps."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from periph_sim.interfaces.commands.watch import files_of
from tests.interfaces.commands.conftest import Run

Step = Callable[[], object]


@pytest.fixture
def typing(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Return a function that takes steps for the next pauses of `watch`, after which Ctrl-C is pressed."""

    def plan(*steps: Step) -> None:
        waiting = iter(steps)

        def sleep(seconds: float) -> None:
            step = next(waiting, None)
            if step is None:
                raise KeyboardInterrupt
            step()

        monkeypatch.setattr("time.sleep", sleep)

    return plan


def edit(path: Path, old: str, new: str) -> None:
    """Edit a file and advance its time stamp by 1 s, which even a coarse file system clock resolves."""
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    later = path.stat().st_mtime_ns + 10**9
    os.utime(path, ns=(later, later))


def test_each_change_is_a_run_and_the_changed_figures_are_printed(
    periph_sim: Run, typing: Callable[..., None], cases: Path
):
    firmware, case = cases / "small_firmware.py", cases / "small.toml"
    typing(
        lambda: None,
        lambda: edit(firmware, "dsp.compute(0)", "dsp.compute(3000)"),
        lambda: edit(firmware, "dsp.compute(3000)", "dsp.compute(30000)"),
        lambda: edit(case, "duration", "duraton"),
        lambda: edit(case, "duraton", "duration"),
        lambda: edit(case, "60 us", "300 us"),
    )
    out = periph_sim.passes("watch", "timing/small.toml")
    lines = [line.rstrip() for line in out.splitlines()]
    titles = [line for line in lines if line.startswith(("small: ", "Error: "))]
    held = "small: PASS, as seen in this run"
    assert titles[:3] == [held, held, "small: FAIL"] and titles[4:] == ["small: FAIL", held]
    assert "there is no key 'duraton'; did you mean duration?" in titles[3]
    assert sum(" budget " in line for line in lines) == 1, "the table is printed once"
    assert "  response worst 750 -> 1543 cycles" in lines
    assert sum(line.startswith("  response: ") and "over its limit of 60.000 us" in line for line in lines) == 2
    assert lines.count("  no figure changed") == 2


def test_a_changed_baseline_is_compared_again(periph_sim: Run, typing: Callable[..., None], cases: Path):
    assert periph_sim("check", "--jobs", "1", "--update-baseline").status == 0
    typing(lambda: (cases / "baselines" / "small.json").write_text("{", encoding="utf-8"))
    out = periph_sim("watch", "timing/small.toml").out
    assert "\n  baseline: equal\n" in out and "small.json: it is not JSON" in out


def test_the_files_of_a_case_include_those_its_firmware_may_import(cases: Path):
    (cases / "small.toml").write_text('[unit.dsp]\nfirmware = "fw/a.py"\nsettings = { sensors = "set.toml" }\n')
    for name in ("fw/a.py", "fw/b.py", "set.toml", "other.toml"):
        (cases / name).parent.mkdir(exist_ok=True)
        (cases / name).touch()
    there = {file.as_posix() for file in files_of(cases / "small.toml") if file.exists()}
    assert there == {"timing/small.toml", "timing/fw/a.py", "timing/fw/b.py", "timing/set.toml"}


def test_a_byte_order_mark_does_not_change_the_files_of_a_case(cases: Path):
    without = {*files_of(cases / "small.toml")}
    text = (cases / "small.toml").read_text(encoding="utf-8")
    (cases / "small.toml").write_text(text, encoding="utf-8-sig")
    assert {*files_of(cases / "small.toml")} == without > {cases / "small_firmware.py"}


def test_too_deeply_nested_tables_are_an_error_until_they_are_corrected(
    periph_sim: Run, typing: Callable[..., None], cases: Path
):
    case = cases / "small.toml"
    deep = f"deep = {'[' * 2000}{']' * 2000}\n"
    text = case.read_text(encoding="utf-8")
    case.write_text(deep + text, encoding="utf-8")
    typing(lambda: edit(case, deep, ""))
    result = periph_sim("watch", "timing/small.toml")
    assert result.status == 0 and "nested too deeply" in result.out and "\nsmall: PASS" in result.out


def test_the_files_of_a_changed_case_include_those_named_in_changes(cases: Path):
    changes = ["unit.dsp.firmware=../fw/a.py", 'unit.dsp.settings.sensors = "../set.toml"', "no change", "seed=2"]
    Path("fw").mkdir()
    for name in ("fw/a.py", "fw/b.py", "set.toml"):
        Path(name).touch()
    added = {*files_of(cases / "small.toml", changes)} - {*files_of(cases / "small.toml")}
    assert {file.as_posix() for file in added} == {"timing/../fw/a.py", "timing/../fw/b.py", "timing/../set.toml"}

"""`periph-sim new`: each kind passes as written, and one line of its firmware breaks the budget that the line names."""

from __future__ import annotations

import errno
import os
import re
from pathlib import Path
from typing import Any

import pytest

from periph_sim.interfaces.commands.new import PROGRAMS, TEMPLATES, write
from periph_sim.interfaces.reports.baselines.files import BadCheck
from periph_sim.interfaces.reports.baselines.outcome import Outcome, run_case
from tests.interfaces.commands.conftest import Run

KINDS = sorted(file.stem for file in TEMPLATES.glob("*.toml"))
TRACES = Path(__file__).parents[3] / "traces"
LINE = re.compile(r'^( *)# (.*?)  # remove the first "#": .*, so budget "(.*)" breaks$', re.MULTILINE)


def words(case: Path) -> dict[str, str]:
    result = run_case(case)
    assert isinstance(result, Outcome), result
    return {verdict.name: verdict.verdict for verdict in result.verdicts}


@pytest.mark.parametrize("kind", KINDS)
def test_a_kind_passes_as_written_and_its_marked_line_breaks_the_named_budget(periph_sim: Run, here: Path, kind: str):
    out = periph_sim.passes("new", kind.replace("_", "-"), "bench/mine")
    assert "\nrun it:           periph-sim run bench/mine.toml\n" in out
    case, firmware = Path("bench/mine.toml"), Path("bench/mine.py")
    assert {path.name for path in Path("bench").iterdir()} == {
        f"mine{file.suffix}" for file in TEMPLATES.glob(f"{kind}.*")
    }
    good = words(case)
    assert good and set(good.values()) == {"pass"}
    text = firmware.read_text(encoding="utf-8")
    (line,) = LINE.finditer(text)
    firmware.write_text(text.replace(line[0], f"{line[1]}{line[2]}"), encoding="utf-8")
    broken = [name for name, verdict in words(case).items() if verdict == "fail"]
    assert broken == [line[3]]


@pytest.mark.parametrize(
    ("kind", "old", "new", "broken"),
    [
        ("eeprom-slave", "dsp.compute(WRITE_TIME)", "dsp.compute(150_000)", {"busy", "refused polls"}),
        ("eeprom-slave", "Fraction(5, 1000)", "Fraction(7, 1000)", {"busy", "refused polls"}),
        ("eeprom-slave", "return place  # the last", "return place + 1  # the last", {"wrong bytes"}),
        ("eeprom-slave", "= i2c.I2CDRR.all\n    page", "= i2c.I2CDRR.all | 1\n    page", {"wrong bytes"}),
        ("i2c-slave", "registers[pointer % len(registers)] = i2c.I2CDRR.all", "i2c.I2CDRR.all", {"wrong bytes"}),
        ("i2c-slave", "pointer = i2c.I2CDRR.all", "pointer = i2c.I2CDRR.all | 2", {"wrong bytes"}),
    ],
)
def test_a_planted_bug_breaks_its_budgets(periph_sim: Run, here: Path, kind: str, old: str, new: str, broken: set[str]):
    assert periph_sim("new", kind, "mine").status == 0
    text = Path("mine.py").read_text(encoding="utf-8")
    assert text.count(old) == 1
    Path("mine.py").write_text(text.replace(old, new), encoding="utf-8")
    assert {name for name, verdict in words(Path("mine.toml")).items() if verdict == "fail"} == broken


def test_the_help_lists_exactly_the_kinds_that_exist(periph_sim: Run):
    listed = re.findall(r"^  ([a-z][a-z0-9-]*) {2,}\S", periph_sim("new", "--help").out, re.MULTILINE)
    assert sorted(kind.replace("-", "_") for kind in listed) == sorted([*KINDS, *PROGRAMS])


def test_a_replay_without_a_capture_gets_a_small_one(periph_sim: Run, here: Path):
    command = next(line for line in periph_sim("new", "replay").out.splitlines() if line.startswith("replay: "))
    arguments = ("replay", "replay.vcd", "--case", "replay.toml", "--tolerance", "2 us")
    assert command.split(None, 1)[1] == "periph-sim replay replay.vcd --case replay.toml --tolerance '2 us'"
    assert periph_sim(*arguments).status == 0
    text = Path("replay.py").read_text(encoding="utf-8")
    Path("replay.py").write_text(text.replace("# dsp.compute", "dsp.compute"), encoding="utf-8")
    assert periph_sim(*arguments).status == 1


def test_a_replay_of_a_given_capture_replaces_its_busiest_target(periph_sim: Run, here: Path):
    capture = str(TRACES / "imu_round.sr")
    assert periph_sim("new", "replay", "--from", capture).status == 0
    assert sorted(path.name for path in here.iterdir()) == ["replay.py", "replay.toml"]
    text = Path("replay.toml").read_text(encoding="utf-8")
    assert text.count("address = 0x68") == 2 and "count = 6" in text
    assert periph_sim("replay", capture, "--case", "replay.toml", "--tolerance", "2 us").status == 0
    assert set(words(Path("replay.toml")).values()) == {"pass"}


@pytest.mark.parametrize("capture", ["i2c_slow_slave.csv", "i2c_eeprom_busy.sr", "nack.sr", "imu_session.sr"])
def test_a_replay_passes_for_captures_with_nacks_and_several_targets(periph_sim: Run, here: Path, capture: str):
    assert periph_sim("new", "replay", "mine", "--from", str(TRACES / capture)).status == 0
    result = periph_sim("replay", str(TRACES / capture), "--case", "mine.toml", "--tolerance", "2 us")
    assert result.status == 0, result.out
    assert set(words(Path("mine.toml")).values()) == {"pass"}


def test_a_stop_between_pointer_and_read_breaks_nothing(periph_sim: Run, here: Path):
    """The STOP sets SCD, which the firmware must not take for the end of the read that follows."""
    assert periph_sim("new", "i2c-slave").status == 0
    assert periph_sim("run", "i2c_slave.toml", "--set", "controller.pointer_by=STOP").status == 0


def test_an_example_is_copied_with_all_firmware_that_it_needs(periph_sim: Run, here: Path):
    assert periph_sim("new", "--example", "two_dsps", "copy").status == 0
    names = {"two_dsps.toml", "sensor_head.py", "imu_hil.py", "imu_models.py"}
    assert {path.name for path in Path("copy").iterdir()} == names
    assert periph_sim("run", "copy/two_dsps.toml", "--seconds", "0.03").out.startswith("two_dsps: PASS")
    text = Path("copy/imu_hil.py").read_text(encoding="utf-8")
    Path("copy/imu_hil.py").write_text(f"{text}\nraise ValueError('the copy is what runs')\n", encoding="utf-8")
    assert "the copy is what runs" in periph_sim.refused("run", "copy/two_dsps.toml", "--seconds", "0.03")


@pytest.mark.parametrize("name", ["imu_hil.toml", "imu_hil.py"])
def test_an_existing_file_is_kept_and_no_other_is_written(periph_sim: Run, here: Path, name: str):
    Path(name).write_text("mine", encoding="utf-8")
    assert (
        periph_sim.refused("new", "--example", "imu_hil")
        == f"{name}: exists already, and nothing was written; give another name"
    )
    assert [path.name for path in here.iterdir()] == [name] and Path(name).read_text() == "mine"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["sensr"], "there is no kind 'sensr'; did you mean sensor?"),
        ([], "give a kind: c, eeprom-slave, i2c-master, i2c-slave, image,"),
        (["sensor", "a b"], "'a b' is no name for files; expected letters, digits, '_' and '-'"),
        (["--example", "imu_hl"], "there is no example 'imu_hl'; did you mean imu_hil or"),
        (["--example", "imu_hil", "a", "b"], "--example takes at most the folder that the copy goes to"),
        (["sensor", "--from", "x.sr"], "--from is for replay, not for sensor"),
        (["replay", "--from", "x.sr"], "x.sr, the file: found no such file or directory"),
        (
            ["replay", "--from", str(TRACES / "host_frames.sr")],
            "is a UART capture; periph-sim new --example uart_logger",
        ),
        (["replay", "--from", str(TRACES / "imu_round.sr"), "--map", "scl=5,sda=1"], "there is no channel '5'"),
    ],
)
def test_a_wrong_argument_is_one_error_message(periph_sim: Run, here: Path, arguments: list[str], sentence: str):
    assert sentence in periph_sim.refused("new", *arguments)
    assert not list(here.iterdir())


@pytest.mark.parametrize(
    ("name", "files", "key"),
    [
        ("imu_hil_image", {"imu_hil.asm", "f28335.inc", "start.inc"}, 'image = "imu_hil.asm"'),
        ("imu_hil_c", {"imu_hil.c", "f28335.h"}, 'sources = ["imu_hil.c"]'),
    ],
)
def test_an_example_is_copied_with_its_sources_and_their_includes(
    periph_sim: Run, here: Path, name: str, files: set[str], key: str
):
    assert periph_sim("new", "--example", name, "bench").status == 0
    assert {path.name for path in Path("bench").iterdir()} == {f"{name}.toml", *files}
    assert key in Path(f"bench/{name}.toml").read_text(encoding="utf-8")
    assert periph_sim("run", f"bench/{name}.toml", "--seconds", "0.001").status in (0, 1)


def test_a_full_disk_leaves_neither_file_of_a_pair(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    opened = Path.open

    def full(path: Path, *arguments: Any, **names: Any) -> Any:
        file = opened(path, *arguments, **names)
        if path.suffix == ".toml":
            monkeypatch.setattr(file, "write", no_room, raising=False)
        return file

    def no_room(text: str) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "open", full)
    with pytest.raises(BadCheck, match=r"one\.toml, its place: found no space left on device"):
        write({tmp_path / "one.py": "main", tmp_path / "one.toml": "name"})
    assert list(tmp_path.iterdir()) == []

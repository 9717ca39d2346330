"""Saved proofs: `prove --table --save` writes them, and `run`, `check` and `worst` use them."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from periph_sim.proof import closed_table
from tests.interfaces.commands.conftest import Run
from tests.proof.proven_slave import FIRMWARE, PROVEN, save_proof, write_slave
from tests.proof.test_closed_table import write_echo

SHORT = '\n[[budget]]\nname = "short round"\nmeasure = "round"\nmax = "1 us"\n'


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a case with a saved proof."""
    case = write_slave(tmp_path_factory.mktemp("saved"))
    save_proof(case)
    return case


@pytest.fixture(scope="module")
def whole_saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a case with a saved proof of all its budgets."""
    case = write_slave(tmp_path_factory.mktemp("whole"), "")
    save_proof(case)
    return case


@pytest.fixture
def whole(tmp_path: Path, whole_saved: Path) -> Path:
    """Return a copy of that case and its proof in the folder of this test."""
    return shutil.copytree(whole_saved.parent, tmp_path, dirs_exist_ok=True) / whole_saved.name


def words(out: str) -> dict[str, str]:
    """Return a dictionary from each budget of a table to its verdict."""
    rows = [line.split("  ") for line in out.splitlines() if line.startswith(" ")]
    return {row[0].strip(): row[-1].strip() for row in rows}


def test_prove_saves_a_closed_table_and_run_shows_it(periph_sim: Run, tmp_path: Path):
    case = write_slave(tmp_path)
    result = periph_sim("prove", str(case), "--table", "--save", "--json")
    assert result.json_object["written"] == [str(tmp_path / "proofs" / "slave.json")]
    out = periph_sim.passes("run", str(case))
    found = words(out)
    assert {name: found[name] for name in (*PROVEN, "round", "slack", "load")} == {
        "wrong bytes": "proven", "reaction": "proven", "round": "seen", "slack": "seen", "load": "seen",
    }  # fmt: skip
    assert out.startswith("image_register_slave: PASS, as seen in this run\n")
    assert "slave.json: 2 of 5 budgets proven for all sequences of rounds that start at least" in out


def test_a_case_whose_budgets_are_all_proven_passes_as_proven(periph_sim: Run, whole: Path):
    out = periph_sim.passes("run", str(whole), "--guaranteed", "--seconds", "0.02")
    assert out.startswith("image_register_slave: PASS, proven\n")
    assert periph_sim("run", str(whole), "--json").json_object["budgets"][0]["proven"] is True


def test_a_broken_table_is_not_saved(periph_sim: Run, tmp_path: Path):
    case = write_slave(tmp_path, SHORT)
    result = periph_sim("prove", str(case), "--table", "--save")
    assert result.status == 1
    assert result.err.endswith(f"{tmp_path / 'proofs' / 'slave.json'} is not written, because no budget is proven\n")
    assert not (tmp_path / "proofs").exists()


def test_a_rejected_case_creates_no_folder(periph_sim: Run, desk: Path):
    assert "has no closed table" in periph_sim.refused("prove", "small.toml", "--table", "--save")
    assert not Path("proofs").exists()
    periph_sim.refused("prove", "smal.toml", "--save")
    assert not Path("coverage").exists()
    assert "none/small.toml: cannot be read" in periph_sim.refused("prove", "none/small.toml", "--table", "--save")


@pytest.mark.parametrize("is_there", [False, True])
def test_a_folder_that_is_not_writable_is_an_error(
    is_there: bool, periph_sim: Run, desk: Path, monkeypatch: pytest.MonkeyPatch
):
    read_only = desk / "proofs" if is_there else desk
    read_only.mkdir(exist_ok=True)
    monkeypatch.setattr("os.access", lambda path, mode: Path(path) != read_only)
    message = f"--save: {read_only} is not writable; change its permissions"
    assert periph_sim.refused("prove", str(desk / "small.toml"), "--table", "--save") == message


def test_a_proof_of_a_changed_case_cannot_be_saved(periph_sim: Run, saved: Path):
    assert "--save with --set: a saved result is of the unchanged case; remove one of them" in periph_sim.refused(
        "prove", str(saved), "--table", "--save", "--set", "seed=2"
    )


def test_guaranteed_fails_with_the_reason_for_each_budget(periph_sim: Run, saved: Path):
    result = periph_sim("run", str(saved), "--guaranteed")
    assert result.status == 1
    assert result.err.splitlines() == [
        "guaranteed: round is not proven: a percentile describes all occurrences of a run",
        "guaranteed: slack is not proven: its values depend on the start of the next round",
        "guaranteed: load is not proven: it is a share of a whole run",
    ]


def test_a_proof_is_not_used_for_a_changed_case(periph_sim: Run, whole: Path):
    file = whole.parent / "proofs" / "slave.json"
    result = periph_sim("run", str(whole), "--guaranteed", "--set", "seed=2")
    assert result.status == 1
    assert words(result.out)["wrong bytes"] == "seen"
    assert result.err == f"guaranteed: no budget is proven: {file} holds for the unchanged case only\n"
    firmware = whole.parent / FIRMWARE
    firmware.write_text(firmware.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    result = periph_sim("run", str(whole), "--guaranteed")
    old = f"{file} is out of date: {FIRMWARE} has changed; write it again with prove --table --save"
    assert (result.status, result.err) == (1, f"guaranteed: no budget is proven: {old}\n")
    assert words(result.out)["wrong bytes"] == "seen" and old not in result.out
    assert periph_sim("run", str(whole)).out.endswith(f"{old}\n")


def test_check_names_a_proof_that_is_out_of_date_once(periph_sim: Run, whole: Path):
    firmware = whole.parent / FIRMWARE
    firmware.write_text(firmware.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    page = whole.parent / "report.html"
    options = ("--jobs", "1", "--update-baseline", "--html", str(page))
    for option, status in (("--guaranteed", 1), ("--no-guaranteed", 0)):
        result = periph_sim("check", str(whole), *options, option)
        assert (result.status, result.out.count("is out of date: ")) == (status, 1)
        assert page.read_text(encoding="utf-8").count("is out of date: ") == 1


def test_a_missing_proof_and_an_invalid_one_are_reported(periph_sim: Run, tmp_path: Path):
    case = write_slave(tmp_path, "")
    file = tmp_path / "proofs" / "slave.json"
    result = periph_sim("run", str(case), "--guaranteed")
    what = f"guaranteed: no budget is proven: there is no {file}; prove --table --save writes it\n"
    assert (result.status, result.err) == (1, what)
    file.parent.mkdir()
    file.write_text("{}", encoding="utf-8")
    result = periph_sim("run", str(case), "--guaranteed")
    assert result.status == 1
    assert f"{file}: is no proof of this version of periph-sim" in result.err
    assert words(result.out)["wrong bytes"] == "seen"


def test_guaranteed_and_questions_exclude_each_other(periph_sim: Run, whole: Path):
    message = "--questions runs the case with other answers, which no proof covers; use --no-guaranteed"
    assert periph_sim.refused("run", str(whole), "--guaranteed", "--questions") == message


def test_check_shows_proven_budgets_and_requires_proofs(periph_sim: Run, saved: Path, tmp_path: Path):
    bare = write_slave(tmp_path, "")
    options = ("--jobs", "1", "--update-baseline")
    result = periph_sim("check", str(saved), *options)
    row = next(line.split() for line in result.out.splitlines() if line.startswith(" image_register_slave"))
    assert (result.status, row[1:5]) == (0, ["2", "3", "0", "0"])
    result = periph_sim("check", str(saved), str(bare), *options, "--guaranteed", "--json")
    shown = result.json_object["cases"]
    assert result.status == 1
    assert [one["proven"] for one in shown] == [[*PROVEN], []]
    assert [finding["text"] for finding in shown[0]["findings"]] == [
        "round is not proven: a percentile describes all occurrences of a run",
        "slack is not proven: its values depend on the start of the next round",
        "load is not proven: it is a share of a whole run",
    ]
    (finding,) = shown[1]["findings"]
    assert finding["text"].startswith("no budget is proven: there is no ")


def test_the_html_report_names_the_proof(periph_sim: Run, saved: Path, tmp_path: Path):
    page = tmp_path / "report.html"
    assert periph_sim("run", str(saved), "--html", str(page)).status == 0
    text = page.read_text(encoding="utf-8")
    assert "slave.json: 2 of 5 budgets proven for all sequences of rounds" in text
    assert 'data-show="proven" aria-pressed="false">proven 2<' in text


def test_worst_explains_the_run_of_a_proof_if_it_is_nearer_to_the_limit(periph_sim: Run, tmp_path: Path):
    """Only in the run of the proof does a frame arrive at the worst instant of the firmware's loop."""
    case = write_echo(tmp_path)
    save_proof(case)
    in_run = periph_sim("worst", str(case), "--seconds", "0.01", "--json").json_object["budgets"]["echo"]
    in_proof = periph_sim("worst", str(case), "--json").json_object["budgets"]["echo"]
    assert "frames_s" in in_proof and "frames_s" not in in_run
    assert in_proof["length_us"] > in_run["length_us"]
    result = periph_sim("worst", str(case))
    assert result.out.startswith(
        f"in a run whose frames start at other times, the worst of {tmp_path / 'proofs' / 'echo.json'}:\n"
    )


def test_no_proof_is_saved_if_a_file_changes_meanwhile(
    periph_sim: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    case = write_slave(tmp_path, "")
    make = closed_table.TableMaker.make

    def edited(maker: closed_table.TableMaker) -> closed_table.StartTable:
        table = make(maker)
        case.write_text(case.read_text(encoding="utf-8") + "\n", encoding="utf-8")
        return table

    monkeypatch.setattr(closed_table.TableMaker, "make", edited)
    result = periph_sim("prove", str(case), "--table", "--save")
    message = "Error: slave.toml has changed while the tables were made, so no proof is saved\n"
    assert result.status == 2 and result.err.endswith(message)
    assert not (tmp_path / "proofs" / "slave.json").exists()


@pytest.mark.parametrize(
    ("key", "value"), [("ticks_per_second", 0), ("proven", {"wrong bytes": {"starts": [2, 1]}}), ("moved", 1)]
)
def test_a_proof_that_was_edited_by_hand_is_rejected(key: str, value: object, periph_sim: Run, whole: Path):
    file = whole.parent / "proofs" / "slave.json"
    tree = json.loads(file.read_text(encoding="utf-8"))
    if isinstance(value, dict):
        value = {name: tree["proven"][name] | change for name, change in value.items()}
    file.write_text(json.dumps(tree | {key: value}), encoding="utf-8")
    result = periph_sim("run", str(whole), "--guaranteed")
    assert result.status == 1
    assert "is no proof of this version of periph-sim" in result.err

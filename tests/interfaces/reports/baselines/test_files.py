"""Baseline files: rejected files and the advice given, and writing of complete files, all together or none."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.interfaces.reports.baselines.check import check
from periph_sim.interfaces.reports.baselines.files import (
    SCHEMA,
    BadCheck,
    Baseline,
    Figures,
    read,
    text_of,
    write_all,
)
from periph_sim.scene.project import baseline_path
from tests.interfaces.reports.baselines.desk import put

numbers = st.integers(0, 2**70)
maybe = st.none() | numbers
names = st.text(st.characters(codec="utf-8"))
figures = st.builds(
    Figures,
    measure=names,
    unit=names,
    count=numbers,
    worst=maybe,
    worst_at=maybe,
    least=maybe,
    least_at=maybe,
    chain_of=st.sampled_from(["worst", "least"]),
    chain=st.lists(names, max_size=3),
)
baselines = st.builds(
    Baseline,
    schema_version=st.just(SCHEMA),
    case=names,
    simulated=numbers,
    ticks_per_second=numbers,
    ticks_per_cycle=numbers,
    events=numbers,
    counts=st.dictionaries(names, numbers, max_size=3),
    budgets=st.dictionaries(names, figures, max_size=2),
)


@given(baselines)
def test_a_written_baseline_reads_back_equal(baseline: Baseline):
    text = text_of(baseline)
    assert Baseline.model_validate(json.loads(text)) == baseline
    assert text == json.dumps(json.loads(text), indent=2, sort_keys=True, ensure_ascii=False) + "\n"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("{", "it is not JSON ("),
        ("\xff", "it is not JSON ("),
        ("[]", "it has no schema_version, expected 1; write it again with --update-baseline"),
        ("{}", "it has no schema_version, expected 1; write it again with --update-baseline"),
        (
            '{"schema_version": 2}',
            "schema_version is 2, expected 1: another version of periph-sim wrote it; compare with that version, "
            "or write it again with --update-baseline",
        ),
        ('{"schema_version": 1}', "case: it is missing; write it again with --update-baseline"),
    ],
)
def test_an_invalid_file_is_rejected_with_advice_and_an_update_replaces_it(cases: Path, text: str, sentence: str):
    path = baseline_path(cases / "small.toml")
    good = path.read_bytes()
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(BadCheck) as caught:
        check([cases], jobs=1)
    assert str(caught.value).startswith(f"{path}: {sentence}") and str(caught.value).endswith("--update-baseline")
    (one,) = check([cases], jobs=1, update=True)
    assert one.state == "written" and path.read_bytes() == good


def test_a_figure_that_is_no_whole_number_is_refused(cases: Path):
    path = baseline_path(cases / "small.toml")
    path.write_text(path.read_text().replace('"worst": 15000', '"worst": 15000.5'), encoding="utf-8")
    with pytest.raises(BadCheck, match=r"budgets\.response\.worst: expected a whole number, but it is 15000\.5;"):
        read(path)


def test_a_full_disk_leaves_every_old_baseline(cases: Path, monkeypatch: pytest.MonkeyPatch):
    put(cases, "a")
    check([cases], jobs=1, update=True)
    before = {path: path.read_bytes() for path in (cases / "baselines").iterdir()}
    for name in ("a", "small"):
        put(cases, name, wait=3000)
    real = Path.write_text

    def full(self: Path, text: str, **how: str) -> int:
        if self.name.startswith(".small."):
            raise OSError(28, "No space left on device")
        return real(self, text, **how)

    monkeypatch.setattr(Path, "write_text", full)
    with pytest.raises(BadCheck, match=r"small\.json, .*no space left"):
        check([cases], jobs=1, update=True)
    assert {path: path.read_bytes() for path in (cases / "baselines").iterdir()} == before


@pytest.mark.posix("permissions")
@pytest.mark.skipif(os.name == "posix" and os.geteuid() == 0, reason="root may write anywhere")
def test_a_read_only_folder_is_an_error(tmp_path: Path):
    tmp_path.chmod(0o500)
    with pytest.raises(BadCheck, match="the folder cannot be created"):
        write_all({tmp_path / "baselines" / "x.json": ""})


def test_a_file_in_place_of_the_folder_is_an_error(tmp_path: Path):
    (tmp_path / "baselines").write_text("", encoding="utf-8")
    with pytest.raises(BadCheck, match="the folder cannot be created"):
        write_all({tmp_path / "baselines" / "x.json": ""})


def test_folders_for_baselines_are_created(tmp_path: Path):
    path = tmp_path / "kept" / "baselines" / "one.json"
    for text in ("{}", "[]"):
        write_all({path: text})
        assert path.read_text(encoding="utf-8") == text

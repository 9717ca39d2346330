"""Results of calls that are kept in a file: which calls are not repeated, and which files are not used."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import msgspec
import pytest

from periph_sim.interfaces.reports import kept_calls
from periph_sim.interfaces.reports.kept_calls import KeptCalls
from periph_sim.proof.calls import T, Ts, call_here
from periph_sim.proof.dependencies import Dependencies, dependencies
from periph_sim.proof.stretch import Job


class Sum(msgspec.Struct):
    numbers: set[int]
    total: int


made: list[int] = []  # the arguments of the calls of `total`


def total(job: Job, number: int) -> Sum:
    made.append(number)
    return Sum({number, 1}, number + len(job.changes))


@pytest.fixture
def case(tmp_path: Path) -> Path:
    made.clear()
    (tmp_path / "small.toml").write_text("seed = 1\n", encoding="utf-8")
    return tmp_path / "small.toml"


def depends_on(case: Path) -> Callable[[], Dependencies]:
    return lambda: dependencies(case.parent, [case])


def results(kept: KeptCalls, case: Path, numbers: Iterable[int], changes: tuple[str, ...] = ()) -> list[Sum]:
    calls = [(Job(str(case), changes), number) for number in numbers]
    return list(kept.call_all(call_here, depends_on(case))(total, calls))


@pytest.fixture
def unfinished(case: Path) -> Path:
    """Write the file with the results for 1, 2 and 3, and return its path."""
    kept = KeptCalls(case)
    results(kept, case, [1, 2, 3])
    assert kept.note == "" and kept.save()
    made.clear()
    return kept.path


def test_only_calls_without_a_result_are_made(case: Path, unfinished: Path):
    kept = KeptCalls(case)
    assert kept.note == f"continued from {unfinished}"
    assert results(kept, case, [0, 2, 5, 2, 5, 3]) == [total(Job(""), number) for number in (0, 2, 5, 2, 5, 3)]
    assert made[:2] == [0, 5] and len(made) == 8
    assert [one.total for one in results(kept, case, [2], ("seed=2",))] == [3]
    kept.remove()
    assert not unfinished.exists()


def test_the_folder_from_which_the_case_is_named_does_not_matter(case: Path, unfinished: Path):
    results(KeptCalls(case), Path("elsewhere") / case.name, [1, 2, 3])
    assert made == []


def test_results_are_kept_after_each_interval(case: Path, monkeypatch: pytest.MonkeyPatch):
    """A signal that the command cannot handle may end it."""
    monkeypatch.setattr(kept_calls, "SAVED_EVERY", -1)

    def stops(work: Callable[[*Ts], T], calls: Sequence[tuple[*Ts]]) -> Iterable[T]:
        yield from call_here(work, calls[:2])
        raise MemoryError

    with pytest.raises(MemoryError):
        list(KeptCalls(case).call_all(stops, depends_on(case))(total, [(Job(str(case)), one) for one in (1, 2, 3)]))
    results(KeptCalls(case), case, [1, 2, 3])
    assert made == [1, 2, 3]


def test_nothing_is_kept_if_a_dependency_has_changed_meanwhile(case: Path):
    kept = KeptCalls(case)
    list(kept.call_all(call_here, lambda: None)(total, [(Job(str(case)), 1)]))
    assert not kept.save() and not kept.path.exists()


def damaged(text: str) -> str:
    """Exchange the results of two calls."""
    tree = msgspec.json.decode(text)
    one, two, *_ = tree["results"]
    tree["results"][one], tree["results"][two] = tree["results"][two], tree["results"][one]
    return msgspec.json.encode(tree).decode()


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda text: text[: len(text) // 2], "is no unfinished table of this version of periph-sim"),
        (lambda text: "garbage", "is no unfinished table of this version of periph-sim"),
        (lambda text: text.replace('"version":1', '"version":2'), "is no unfinished table of this version"),
        (damaged, "is not continued, because its contents are damaged"),
        (lambda text: text.replace('"periph_sim":"', '"periph_sim":"0'), "because periph_sim itself has changed"),
    ],
)
def test_the_note_states_why_a_file_cannot_be_used(
    change: Callable[[str], str], reason: str, case: Path, unfinished: Path
):
    unfinished.write_text(change(unfinished.read_text(encoding="utf-8")), encoding="utf-8")
    kept = KeptCalls(case)
    assert reason in kept.note and kept.note.endswith("; the table is made anew")
    results(kept, case, [1, 2, 3])
    assert made == [1, 2, 3]


def test_the_file_of_another_or_a_changed_case_is_not_used(case: Path, unfinished: Path):
    other = case.with_name("other.toml")
    other.write_bytes(case.read_bytes())
    unfinished.with_name("other.unfinished").write_bytes(unfinished.read_bytes())
    assert "it belongs to another case file than other.toml" in KeptCalls(other).note
    case.write_text("seed = 2\n", encoding="utf-8")
    assert "because small.toml has changed; the table is made anew" in KeptCalls(case).note

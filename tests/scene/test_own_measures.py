"""A user's own measures, defined in a case or in a file that several cases share."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim import BadCase, Scene, load
from tests.scene.small import sentence_of

CASE = """\
name = "own"
duration = "60 ms"
measures_from = "shared.toml"

[measures]
"late answers" = "from record transfer acknowledge to record transfer answer, for each record transfer read"
"uneven" = "jitter of late answers"
"rounds" = "count of record round begin, for each record round due, measured at record round begin"

[unit.dsp]
firmware = "imu_hil"
modules = ["I2C-A", "SCI-A", "GPIO"]
pins = { MODEL = 34 }

[controller]
order = ["gyroscope", "accelerometer", "magnetometer"]

[host]

[[budget]]
name = "shipped"
measure = "response"
max = "60 us"

[[budget]]
name = "own"
measure = "late answers"
max = "60 us"

[[budget]]
name = "uneven"
measure = "uneven"
max = "9 us"

[[budget]]
name = "shared"
measure = "runs"
exactly = 9

[[budget]]
name = "rounds"
measure = "rounds"
exactly = 3
"""
SHARED = """\
# of all our boards
"runs" = "count of edge MODEL change"
"elsewhere" = "count of edge BRAKE rise"
"""


@pytest.fixture
def case_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("shared.toml").write_text(SHARED, encoding="utf-8")
    Path("own.toml").write_text(CASE, encoding="utf-8")
    return Path("own.toml")


def test_a_named_measure_gives_the_results_of_its_text(case_file: Path):
    verdicts = {v.name: v for v in Scene(load(case_file)).run().budgets}
    own, shipped = verdicts["own"], verdicts["shipped"]
    figures = [(v.worst, v.at_s, v.count, v.measured, v.occasions, v.verdict) for v in (own, shipped)]
    assert figures[0] == figures[1] and own.count == 9
    assert own.measure == "from record transfer acknowledge to record transfer answer, for each record transfer read"
    assert verdicts["uneven"].measure == f"jitter of {own.measure}" and verdicts["uneven"].count == 8
    assert {v.verdict for v in verdicts.values()} == {"pass"}
    assert (verdicts["rounds"].measured, verdicts["rounds"].occasions) == (3, 3)


def test_an_edit_of_the_shared_file_applies_to_the_next_scene(case_file: Path):
    case = load(case_file)
    assert Scene(case).run().budgets[3].worst == 9
    Path("shared.toml").write_text(SHARED.replace("change", "rise"), encoding="utf-8")
    assert Scene(load(case_file)).run().budgets[3].worst == 4


@pytest.mark.parametrize(
    ("line", "by", "message"),
    [
        (
            '"jitter of late answers"',
            '"uneven"',
            "own.toml, line 7: measures.uneven: measure 'uneven' is defined by itself; write it in events",
        ),
        (
            '"jitter of late answers"',
            '"jitter of rounds"\n"x" = "jitter of y"\n"y" = "jitter of x"',
            "own.toml, line 8: measures.x: measure 'x' is defined by itself; write it in events",
        ),
        (
            "jitter of late answers",
            "jitter of late anwsers",
            "own.toml, line 7: measures.uneven: there is no measure 'late anwsers'; did you mean late answers?",
        ),
        (
            "count of record round begin",
            "count of record round start",
            "own.toml, line 8: measures.rounds: 'count of record round start, for each record round due, measured at "
            "record round begin': 'start' where due, missed, begin, end, next or refused is expected; it has due, "
            "missed, begin, end, next, refused",
        ),
        (
            '"uneven" =',
            '"response" =',
            "own.toml, line 7: measures.response: there is a measure 'response' already; give this one another name",
        ),
        (
            '"uneven" =',
            '"period of frame" =',
            "own.toml, line 7: measures.period of frame: 'period' begins the text of other measures; give this one "
            "another name",
        ),
        (
            '"uneven" =',
            '"time lost" =',
            "own.toml, line 7: measures.time lost: 'time' begins the text of other measures; give this one another "
            "name",
        ),
        (
            '"uneven" =',
            '"span:model" =',
            "own.toml, line 7: measures.span:model: 'span:' begins the text of other measures; give this one another "
            "name",
        ),
        (
            '"uneven" =',
            '"runs" =',
            "own.toml, line 7: measures.runs: shared.toml has a measure 'runs', too; give one of them another name",
        ),
        ('"uneven" =', '"rounds" =', 'own.toml, line 8: "rounds" is given already in line 7; remove one of them'),
        (
            '"shared.toml"',
            '"shard.toml"',
            "shard.toml: cannot be read (No such file or directory); did you mean shared.toml?",
        ),
        (
            'measure = "runs"',
            'measure = "elsewhere"',
            "own.toml, line 37: budget.shared.measure: there is no wire 'BRAKE'; it has SDA, SCL, RX, TX, MODEL",
        ),
        (
            'measure = "runs"',
            'measure = "rnus"',
            "own.toml, line 37: budget.shared.measure: there is no measure 'rnus'; did you mean runs or rounds?",
        ),
        (
            "from record transfer acknowledge to record transfer answer",
            "from record transfer acknowledge to record transfer answer, same transfer",
            "own.toml, line 27: budget.own.measure: 'from record transfer acknowledge to record transfer answer, same "
            "transfer, for each record transfer read': pairs of one transfer are counted transfer by transfer; leave "
            "'for each record transfer read' out",
        ),
    ],
)
def test_an_invalid_measure_is_refused_in_one_sentence_with_its_place(
    case_file: Path, line: str, by: str, message: str
):
    assert line in CASE
    case_file.write_text(CASE.replace(line, by, 1), encoding="utf-8")
    assert sentence_of(BadCase, lambda: Scene(load(case_file))) == message


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('"runs" = 3', "shared.toml, line 1: runs: it is no sentence in quotes"),
        (
            '\n"runs" = "jitter of runs"',
            "shared.toml, line 2: runs: measure 'runs' is defined by itself; write it in events",
        ),
        ('"runs" = "count of edge"', "shared.toml, line 1: runs: 'count of edge' ends where a wire is expected"),
        (
            "import os",
            "shared.toml, line 1: it is not TOML: Expected '=' after a key in a key/value pair in `import os`; "
            'write a number, as 12 or 0x0c, or a text in quotes: import = "os"',
        ),
    ],
)
def test_a_mistake_in_the_shared_file_is_reported_with_its_place(case_file: Path, text: str, message: str):
    Path("shared.toml").write_text(text, encoding="utf-8")
    assert sentence_of(BadCase, lambda: Scene(load(case_file))) == message

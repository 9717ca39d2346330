"""JUnit XML and GitHub annotations: the XML is parsed again, and the line numbers are compared."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree as xml

import pytest

from periph_sim.interfaces.reports.baselines.check import check
from periph_sim.interfaces.reports.baselines.ci_output import github, junit
from periph_sim.interfaces.reports.baselines.outcome import RejectedCase
from tests.interfaces.reports.baselines.desk import put
from tests.unwrapped import unwrapped


def test_junit_has_a_suite_for_each_case_and_a_test_for_each_budget(cases: Path):
    put(cases, "z", sdir_wait=False, breaks='breaks = ["wrong bytes"]\n')
    checks = check([cases], jobs=1)
    root = xml.fromstring(junit(checks))
    assert (root.get("tests"), root.get("failures"), root.get("errors")) == ("8", "1", "0")
    small, z = root
    assert [small.get(key) for key in ("name", "tests", "failures")] == ["small", "4", "0"]
    assert [test.get("name") for test in small.iter("testcase")] == ["response", "wrong bytes", "model", "the case"]
    first = checks[0].outcome
    counts = {"events": first.figures.events, "polls_skipped": first.figures.counts["polls_skipped"]}
    counts |= dict.fromkeys(("missed", "nacked", "frames", "stuck", "overruns", "resets", "SCI bytes"), 0)
    counts |= {"rounds": 2, "I2C bytes": 18}
    shown = {p.get("name"): p.get("value") for p in small.findall("properties/property")}
    assert shown == {"baseline": "equal"} | {key: str(count) for key, count in counts.items()}
    assert small.get("time") == f"{first.result.wall_s:.6f}"
    response = small.find("testcase[@name='response']/properties")
    assert {p.get("name"): p.get("value") for p in response} == {
        "measure": "response",
        "count": "2",
        "worst_cycles": "750",
        "worst_at_cycles": "793500",
        "least_cycles": "750",
        "least_at_cycles": "793500",
        "limit_us": "60.0",
        "verdict": "seen",
        "must_break": "no",
    }
    # A budget that must break and does is no failure; the missing baseline is a failure of the case as a whole.
    assert [test.get("name") for test in z.iter("testcase") if test.find("failure") is not None] == ["the case"]
    wrong = z.find("testcase[@name='wrong bytes']")
    assert wrong is not None and wrong.get("line") == "25" and wrong.get("file") == "cases/z.toml"


def test_junit_has_one_failure_with_all_findings_of_a_budget(cases: Path):
    put(cases, sdir_wait=False)
    (suite,) = xml.fromstring(junit(check([cases], jobs=1)))
    failure = suite.find("testcase[@name='wrong bytes']/failure")
    assert failure is not None and failure.text is not None
    assert failure.get("message") == failure.text.splitlines()[0]
    assert failure.text.splitlines()[0].startswith("wrong bytes breaks: 12 bytes")
    assert failure.text.splitlines()[1].startswith("wrong bytes worst 0 -> 12 bytes: gyroscope read")


def test_a_case_that_cannot_run_has_an_annotation():
    (line,) = github([], [RejectedCase(Path("a,b/bad.toml"), "there is\nno firmware")])
    assert line == "::error file=a%2Cb/bad.toml,line=1,title=periph-sim check%3A bad::there is%0Ano firmware"


def test_junit_has_one_element_per_line_and_only_valid_characters():
    """XML 1.0, section 2.2 allows tab, line feed, carriage return, U+0020-D7FF, U+E000-FFFD, and U+10000 and above."""
    kept, left_out = " \ud7ff\ue000\ufffd\U00010000\U0010ffff", "\0\x08\x0b\x0c\x0e\x1f\ud800\udfff\ufffe\uffff"
    why = kept + "\ufffd" * len(left_out)
    assert junit([], [RejectedCase(Path("a/bad.toml"), kept + left_out)]).splitlines() == [
        '<?xml version="1.0" encoding="utf-8"?>',
        '<testsuites name="periph-sim check" tests="1" failures="0" errors="1">',
        '  <testsuite name="bad" file="a/bad.toml" tests="1" failures="0" errors="1">',
        '    <testcase classname="bad" name="the case" file="a/bad.toml" line="1">',
        f'      <error message="{why}" type="check">{why}</error>',
        "    </testcase>",
        "  </testsuite>",
        "</testsuites>",
    ]


def test_junit_escapes_text(cases: Path):
    path = put(cases)
    path.write_text(path.read_text().replace('name = "model"', 'name = "<mo&\\"del>"'), encoding="utf-8")
    (suite,) = xml.fromstring(junit(check([cases], jobs=1)))
    assert '<mo&"del>' in [test.get("name") for test in suite.iter("testcase")]


def test_findings_of_a_case_without_a_name_in_its_file_are_at_line_1(cases: Path):
    path = put(cases, "nameless")
    path.write_text(path.read_text().replace('name = "nameless"\n', "", 1), encoding="utf-8")
    checks = check([path], jobs=1, changes=["name=given"])
    (suite,) = xml.fromstring(junit(checks))
    assert [test.get("line") for test in suite.iter("testcase")][-1] == "1"
    assert github(checks)[0].startswith("::error file=cases/nameless.toml,line=1,")


def test_annotations_point_at_the_budget_in_the_case_file(cases: Path):
    path = put(cases, sdir_wait=False, breaks='breaks = ["model"]\n')
    lines = path.read_text(encoding="utf-8").splitlines()
    first, second, third, cause = github(check([cases], jobs=1))
    head = lines.index('name = "wrong bytes"')  # the line before it, counted from 1
    assert lines[head - 1] == "[[budget]]"
    title = "title=periph-sim check%3A small"
    assert first.startswith(
        f"::error file=cases/small.toml,line={head},{title}::"
        "wrong bytes breaks: 12 bytes is over its limit of 0 bytes, at 0.005195 s%0Awrong bytes worst 0 -> 12 bytes: "
    )
    assert second.startswith(f"::error file=cases/small.toml,line=1,{title}::model holds, but is listed in breaks")
    assert third.startswith(f"::error file=cases/small.toml,line=2,{title}::bytes on the bus differ from the baseline")
    writes = Path("cases/small_firmware.py").read_text(encoding="utf-8").splitlines()
    line = writes.index("            i2c.I2CDXR.all = next(buffer)") + 1
    assert cause.startswith(f"::warning file=cases/small_firmware.py,line={line},{title}::wrong bytes: ")
    assert cause.partition("::wrong bytes: ")[2].startswith("I2CDXR written%0Awrong bytes 12 bytes, at most 0 ")
    written = f"I2CDXR = 0x12 written, before the read's START [small_firmware.py:{line} (batch_read)]"
    assert written in unwrapped(cause.replace("%0A", "\n"))


def test_firmware_that_is_not_below_this_folder_gets_no_annotation(cases: Path, monkeypatch: pytest.MonkeyPatch):
    put(cases.resolve(), sdir_wait=False)
    checks = check([cases.resolve()], jobs=1)
    assert [line.partition(" ")[0] for line in github(checks)][-1] == "::warning"
    (cases / "below").mkdir()
    monkeypatch.chdir(cases / "below")
    assert {line.partition(" ")[0] for line in github(checks)} == {"::error"}


@pytest.mark.parametrize(
    "blamed", [None, SimpleNamespace(place=None), SimpleNamespace(place=SimpleNamespace(file=None))]
)
def test_a_cause_without_a_line_of_firmware_gets_no_annotation(blamed: Any):
    outcome = SimpleNamespace(path=Path("small.toml"), figures=SimpleNamespace(case="small"))
    causes = {"response": SimpleNamespace(blamed=blamed)}
    one: Any = SimpleNamespace(outcome=outcome, findings=[], causes=causes, coverage=None)
    assert github([one]) == []


def test_annotations_escape_separators(cases: Path):
    path = put(cases / "a,b:c")
    path.write_text(path.read_text().replace('name = "model"', 'name = "100%:,"'), encoding="utf-8")
    put(cases / "a,b:c", "other")
    check([path], jobs=1, update=True)
    path.write_text(path.read_text().replace('max = "300 us"', 'max = "3 us"'), encoding="utf-8")
    line, cause = github(check([path], jobs=1))
    assert line.startswith("::error file=cases/a%2Cb%3Ac/small.toml,line=29,")
    assert line.endswith("::100%25:, breaks: 250.000 us is over its limit of 3.000 us, at 0.000001 s")
    assert cause.startswith("::warning file=cases/a%2Cb%3Ac/small_firmware.py,line=") and "\n" not in cause

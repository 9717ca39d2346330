"""The page as text: it is valid, complete and self-contained, and texts of the case cannot inject HTML."""

from __future__ import annotations

import json
import re
import subprocess
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import Element

import html5lib
import pytest

import periph_sim
from periph_sim import form
from periph_sim.core.time import Timebase
from periph_sim.interfaces.reports.explain.chain import Chain, FirmwarePlace, Part, Step
from periph_sim.interfaces.reports.html.failure import Failure, SourceLines
from periph_sim.interfaces.reports.html.gather import CaseReport, commit_of
from periph_sim.interfaces.reports.html.page import page, versions
from periph_sim.timing.verdict import legend
from tests.interfaces.reports.html.made import US, budget, drawn, report, report_of, run_of, small_report

ROOT = Path(__file__).parents[4]
MOST = 5_000_000  # bytes, for 10 s
COUNTED = ("missed rounds", "nacked rounds", "wrong bytes", "overruns")  # these have one number per run


def parsed(text: str) -> Element:
    """Parse the page as a browser does, but fail at any HTML error."""
    return html5lib.HTMLParser(strict=True, namespaceHTMLElements=False).parse(text)


def said(element: Element) -> str:
    return " ".join(" ".join(element.itertext()).split())


@pytest.fixture(scope="module")
def imu_hil() -> tuple[CaseReport, str]:
    """Return the report of the reference case, run for its full ten seconds, and its page."""
    found = report_of(ROOT / "timing" / "imu_hil_published.toml")
    return found, page([found], found.name)


@pytest.mark.long
def test_ten_seconds_are_a_page_of_less_than_five_megabytes(imu_hil: tuple[CaseReport, str]) -> None:
    report, text = imu_hil
    assert report.simulated_s == 10
    assert len(text.encode()) < MOST
    parsed(text)


@pytest.mark.long
def test_every_value_that_was_measured_is_in_a_plot(imu_hil: tuple[CaseReport, str]) -> None:
    report, text = imu_hil
    tree = parsed(text)
    plots = 0
    for number, one in enumerate(report.budgets, 1):
        section = tree.find(f".//section[@id='c1b{number}']")
        bars = section.findall(".//{http://www.w3.org/2000/svg}rect[@class='bar']")
        counts = [int(re.search(r": (\d+) values?$", said(bar))[1]) for bar in bars]
        if one.distribution is not None:
            plots += 1
            assert sum(counts) == one.verdict.count > 0
        else:
            assert one.verdict.measure in COUNTED and not counts
    assert plots == sum(one.verdict.measure not in COUNTED for one in report.budgets) >= 6


@pytest.mark.long
def test_every_budget_has_figures_reason_and_source(imu_hil: tuple[CaseReport, str]) -> None:
    report, text = imu_hil
    rows = parsed(text).findall(".//div[@class='verdicts']//tbody/tr")
    assert [said(row.find("td")) for row in rows] == [one.verdict.name for one in report.budgets]
    one = report.budgets[1].verdict
    response = said(rows[1])
    for part in ("response", one.word, f"{one.worst:.3f} us", "10 us", f"{one.margin:.3f} us", one.why):
        assert part in response
    assert f"{one.at_s:.6f} s" in response and str(one.count) in response and one.count == 1500
    assert "dissertation section 5.4: about 250 us" in said(rows[0])


@pytest.mark.long
def test_the_page_describes_the_run(imu_hil: tuple[CaseReport, str]) -> None:
    root = parsed(imu_hil[1])
    assert "imu_hil_published PASS, as seen in this run" in said(root.find(".//header"))
    for part in ("10 s", "SYSCLKOUT of dsp 150 MHz", "dsp.i2c.xrdy_w1c"):
        assert part in said(root.find(".//article"))


def test_broken_budgets_are_first_and_known_bugs_follow(small: CaseReport) -> None:
    rows = parsed(page([small], "small")).findall(".//div[@class='verdicts']//tbody/tr")
    names = ["<script>alert(1)</script>", "misspelt", "known bug", "response", "words", "nothing"]
    assert [said(row.find("td")) for row in rows] == names
    assert [row.get("data-verdict") for row in rows] == ["broken", "not judged", "broken"] + ["seen"] * 3
    assert "broken, as it must" in said(rows[2])


def test_failures_are_in_order_of_time_and_known_breaks_have_a_cause(small: CaseReport) -> None:
    late, early = (
        replace(budget(name, 30.0), failure=Failure(f"of {name}"), over_time=run_of(numbers, max=10))
        for name, numbers in (("late", [1, 2, 30]), ("early", [1, 20, 30]))
    )
    known = replace(late, must_break=True, verdict=replace(late.verdict, name="known"))
    root = parsed(page([report(late, known, early)], "by hand"))
    failures = root.findall(".//ul[@class='failures']/li")
    assert [(said(one).partition(" :")[0], one.get("class")) for one in failures] == [
        ("early", None),
        ("late", None),
        ("known", "known"),
    ]
    sections = [section.find(".//h3").text.strip() for section in root.findall(".//section")]
    assert sections == ["early", "late", "known"]
    of_known = parsed(page([small], "small")).find(".//section[@id='c1b3']")
    assert "is over its limit of 1.000 us" in said(of_known.find(".//p[@class='failure known']"))
    assert of_known.find("./details").get("open") is not None


@pytest.mark.parametrize(
    ("unexpected", "known", "text", "mark"),
    [
        (3, 1, "and 1 more budget, in the table below", "known"),
        (3, 2, "and 2 more budgets, in the table below", "known"),
        (4, 1, "and 2 more budgets, in the table below", None),
    ],
)
def test_further_failures_are_counted_and_marked_as_known_if_all_are(
    unexpected: int, known: int, text: str, mark: str | None
) -> None:
    found = [replace(budget(f"b{number}", 30.0), failure=Failure("of it")) for number in range(unexpected + known)]
    found[unexpected:] = [replace(one, must_break=True) for one in found[unexpected:]]
    last = parsed(page([report(*found)], "by hand")).findall(".//ul[@class='failures']/li")[-1]
    assert (said(last), last.get("class")) == (text, mark)


def test_texts_of_a_case_cannot_inject_html(small: CaseReport) -> None:
    evil = "</script><script>alert(3)</script>\"'><img src=x onerror=alert(4)>&amp;"
    timeline = drawn()
    timeline.groups[0][1][0].says[0] = evil
    one = replace(
        budget(evil, 40.0, timeline=timeline),
        source=evil,
        limits=((evil, evil),),
        failure=Failure(evil, evil, evil, evil, SourceLines(evil, 1, ((1, evil),))),
        over_time=run_of([1, 2, 30], max=10),
    )
    case = replace(
        report(one, name=evil),
        about=evil,
        findings=(evil,),
        notes=(evil,),
        changes=(evil,),
        options=(evil,),
        commit=evil,
    )
    tree = parsed(page([case, small], evil, evil))
    scripts = tree.findall(".//script")
    plots = [one for of in (case, small) for one in of.budgets if one.over_time is not None]
    timelines = [one for of in (case, small) for one in of.budgets if one.timeline is not None]
    assert len(scripts) == 1 + len(plots) + sum(1 + len(one.others) for one in timelines)
    assert tree.findall(".//img") == []
    data = [json.loads(script.text) for script in scripts if script.get("type") == "application/json"]
    assert sum(one["says"][0] == evil for one in data if "says" in one) == 1
    for place in (".//section//h3", ".//h1", ".//ul[@class='failures']", ".//dl[@class='provenance']"):
        assert any(evil in "".join(found.itertext()) for found in tree.findall(place)), place


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({}, "seen"),
        ({"verdict": "not judged"}, "not judged"),
        ({"verdict": "fail"}, ""),
    ],
)
def test_the_verdicts_have_the_legend_of_the_terminal(changes: dict[str, object], word: str) -> None:
    one = budget("a", 2.0)
    text = page([report(replace(one, verdict=replace(one.verdict, **changes)))], "a report")  # type: ignore[arg-type]
    shown = re.search(r'<p class="quiet legend">(.*?)</p>', text, re.DOTALL)
    assert shown is not None and shown[1] == "; ".join(legend({word}))
    assert ("seen: " in shown[1], "not judged: " in shown[1]) == (word == "seen", word == "not judged")


def test_assumptions_have_their_number_in_the_head() -> None:
    one = replace(report(budget("a", 2.0)), options=("dsp.i2c.bcm_reset",))
    assert "<summary>Assumes 1 undocumented behaviour</summary>" in page([one], "a report")
    both = replace(one, options=(*one.options, "dsp.i2c.rrdy_point"))
    assert "<summary>Assumes 2 undocumented behaviours</summary>" in page([both], "a report")


def test_the_first_three_notes_are_visible_and_the_others_folded() -> None:
    notes = ("eeprom: a page overrun", "b", "c", "d")
    tree = parsed(page([replace(report(budget("a", 2.0)), options=("x",), notes=notes)], "a report"))
    (shown,) = (e for e in tree.iter("ul") if e.get("class") == "notes")
    assert [one.text for one in shown.findall("li")[:3]] == ["note: eeprom: a page overrun", "note: b", "note: c"]
    (folded,) = shown.iter("details")
    assert [one.text for one in folded.iter("li")] == ["note: d"]


@pytest.mark.long
def test_a_page_refers_to_nothing_outside_of_it(imu_hil: tuple[CaseReport, str]) -> None:
    tree = parsed(imu_hil[1])
    for element in tree.iter():
        for name, value in element.attrib.items():
            if name in ("src", "href", "action", "data", "srcset"):
                assert value.startswith(("#", "data:,")), (element.tag, value)
    for style in tree.findall(".//style"):
        assert "url(" not in style.text and "@import" not in style.text
    addresses = set(re.findall(r"https?://[^\s\"'<]*", imu_hil[1]))
    assert addresses == {"http://www.w3.org/2000/svg"}  # a namespace, which is not fetched


def test_the_page_contains_no_path_of_the_machine(tmp_path: Path) -> None:
    text = page([small_report(tmp_path)], "small")
    for path in (str(tmp_path), str(ROOT), str(Path.home()), "/tmp/"):
        assert path not in text


def test_pages_of_equal_runs_differ_in_the_wall_time_only(small: CaseReport, tmp_path: Path) -> None:
    again = small_report(tmp_path)
    assert page([again], "x") == page([small], "x")
    slower = page([replace(small, wall_s=7.5)], "x")
    assert slower != page([small], "x")

    def cut(text: str) -> str:
        return re.sub(r'<dd class="wall">.*?</dd>', "", text)

    assert cut(slower) == cut(page([small], "x"))


def test_a_case_without_budgets_has_a_page(tmp_path: Path) -> None:
    tree = parsed(page([report()], "empty"))
    assert "by hand" not in said(tree.find(".//h1")) and "empty PASS, as seen in this run" in said(tree.find(".//h1"))


def test_an_overview_counts_cases_and_marks_findings(small: CaseReport) -> None:
    broken = replace(report(budget("b", 11.0)), findings=("b breaks: 11.000 us is over its limit",))
    tree = parsed(page([report(budget("a", 1.0)), broken], "all"))
    assert said(tree.find(".//h1")) == "all 1 of 2 as they should be"
    assert said(tree.find(".//h1/span")) and tree.find(".//h1/span").get("class") == "chip bad"
    assert [said(item) for item in tree.findall(".//article//ul[@class='findings']/li")] == list(broken.findings)


def test_joined_conditions_are_listed_as_limits(tmp_path: Path) -> None:
    text = (ROOT / "timing" / "imu_hil_published.toml").read_text(encoding="utf-8").split("[[budget]]")[0]
    text = text.replace('"10 s"', '"0.1 s"')
    joined = 'and = [{ measure = "value error of gyroscope", max = "2 LSB" }]'
    path = tmp_path / "joined.toml"
    path.write_text(
        f'{text}[[budget]]\nname = "b"\nmeasure = "age of gyroscope"\nmax = "25 ms"\nafter = "20 ms"\n{joined}\n',
        encoding="utf-8",
    )
    (one,) = report_of(path).budgets
    assert one.limits == (("age of gyroscope max", "25 ms"), ("value error of gyroscope max", "2.000 LSB"))
    assert one.distribution is not None and (one.distribution.unit, one.distribution.worst) == ("LSB", 5.82375)


def git(folder: Path, *command: str) -> str:
    who = ("-c", "user.name=a", "-c", "user.email=a@b", "-c", "commit.gpgsign=false")
    return subprocess.run(["git", "-C", str(folder), *who, *command], check=True, capture_output=True, text=True).stdout


def test_the_commit_is_named_and_marked_if_files_differ_from_it(tmp_path: Path) -> None:
    git(tmp_path, "init", "-q")
    assert commit_of(tmp_path) == ""  # there is no commit yet
    case = tmp_path / "timing" / "case.toml"
    case.parent.mkdir()
    case.write_text("a", encoding="utf-8")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-qm", "first")
    commit = git(tmp_path, "rev-parse", "HEAD")[:12]
    (tmp_path / "report.html").write_text("new", encoding="utf-8")  # a file that is not committed
    assert commit_of(case.parent) == commit
    case.write_text("b", encoding="utf-8")
    assert commit_of(case.parent) == f"{commit}, and uncommitted changes"


def test_without_a_repository_or_git_there_is_no_commit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    assert commit_of(tmp_path) == "" and commit_of(tmp_path / "nowhere") == ""
    monkeypatch.setenv("PATH", "")
    assert commit_of(Path(__file__).parent) == ""


def test_versions_include_the_form_of_the_core() -> None:
    assert versions().startswith(f"periph-sim {periph_sim.__version__}, {form.running}, Python 3.")


RESPONSE = budget("response", 8.0)
PLACE = FirmwarePlace("batch_read", 98, Path("/home/somebody/imu_hil.py"))


def explained(chain: Chain) -> tuple[list[list[Element]], list[str]]:
    """Return the rows of the tables of an explanation and the sentences in class `quiet`."""
    text = page([report(replace(RESPONSE, explanation=chain))], "by hand")
    root = parsed(text)
    tables = root.findall(".//table[@class='chain']")
    return [table.findall("./tbody/tr") for table in tables], [one.text for one in root.findall(".//p[@class='quiet']")]


def cells(row: Element) -> list[str]:
    return ["".join(cell.itertext()) for cell in row]


def test_steps_and_shares_have_their_places_without_folders() -> None:
    (steps, shares), quiet = explained(
        Chain(
            RESPONSE.verdict,
            Timebase(150_000_000),
            8 * US,
            (Step(-2 * US, "START"), Step(1 * US, "wait", 6000, PLACE)),
            (Part("interrupt", "SCIRXINTA", 6 * US, 3, PLACE), Part("wait", "AAS", 2 * US)),
            typical=5 * US,
            more=(Part("interrupt", "SCIRXINTA", 3 * US), Part("wait", "AAS", -1)),
        )
    )
    place = "imu_hil.py:98 (batch_read)"
    assert [[row.find(".//button").get("data-go"), *cells(row)] for row in steps] == [
        ["-6000", "-2.000 us", "", "START"],
        ["3000", "1.000 us", "2.000 us", f"wait {place}"],
    ]
    assert [[row.find(".//span[@class='share']").get("title"), *cells(row)] for row in shares] == [
        ["75.0 %", "6.000 us", "", f"SCIRXINTA, 3 times {place} (+3.000 us)"],
        ["25.0 %", "2.000 us", "", "wait for AAS"],  # a difference of a third of a nanosecond is not shown
    ]
    assert "Its least critical occurrence took 5.000 us; in brackets: the difference from it." in quiet


def test_an_occurrence_without_length_has_no_shares() -> None:
    tables, quiet = explained(Chain(RESPONSE.verdict, Timebase(150_000_000), 0, ()))
    assert (tables, [text for text in quiet if "least critical" in text]) == ([], [])

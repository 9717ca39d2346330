"""The page in a real browser: its order, folded parts, navigation between violations, and the protocol table."""

from __future__ import annotations

from dataclasses import replace

import pytest
from playwright.sync_api import Page

from periph_sim.interfaces.reports.coverage_line import PhasesReport
from periph_sim.interfaces.reports.html.failure import Failure, SourceLines
from periph_sim.interfaces.reports.html.gather import BudgetReport, CaseReport
from periph_sim.interfaces.reports.html.protocol import Row
from periph_sim.interfaces.reports.html.timeline import Lane, Timeline
from tests.interfaces.reports.html.conftest import Open
from tests.interfaces.reports.html.made import US, budget, drawn, report, run_of

MS = 1000 * US
SCREEN = 900  # pixels
ROWS = (
    Row(-90 * US, -60 * US, "RX", "", "", "", "", (("01", "", ""), ("FF", "error", "")), False),
    Row(-15 * US, 5 * US, "I2C", "START", "0x68", "W", "ACK", (("1D", "NACK", ""),), False),
    Row(60 * US, 180 * US, "I2C", "Sr", "0x68", "R", "ACK", (("12", "ACK", ""), ("34", "NACK", "")), True),
)


def waves(at: int = 12_345 * US) -> Timeline:
    return replace(drawn(), rows=ROWS, origin=at)


def broken(name: str = "late") -> BudgetReport:
    """Return a budget broken by 30 us at 2 ms, 40 us (the worst) at 4 ms and 20 us at 5 ms; the last has no waves."""
    one = budget(name, 40.0, timeline=waves(4 * MS))
    return replace(
        one,
        verdict=replace(one.verdict, at_s=0.004),
        failure=Failure("40.000 us is over its limit of 10.000 us", why="Most of it went into", place="a.py:7"),
        over_time=run_of([5, 30, 6, 40, 20], max=10),
        per_second=1000 * MS,
        others=((2 * MS, waves(2 * MS)),),
    )


def test_the_page_begins_with_the_failure_and_its_cause(opened: Open) -> None:
    good = report(budget("fine", 2.0, timeline=waves()), name="good")
    page = opened(good, report(budget("other", 3.0), broken(), name="bad"), folded=True)
    message = page.locator("header .failures").inner_text()
    assert message == "bad: late: 40.000 us is over its limit of 10.000 us. Most of it went into a.py:7."
    assert page.locator("article").evaluate_all("all => all.map((one) => one.id)") == ["c2", "c1"]
    names = page.locator("#c2 section h3").evaluate_all("all => all.map((one) => one.textContent.split(' ')[0])")
    assert names == ["late", "other"]


def test_of_thirteen_cases_only_the_failing_one_is_unfolded(small: CaseReport, opened: Open) -> None:
    passing = [replace(small, name=f"case {n}", standing="good", verdict="pass") for n in range(12)]
    passing = [
        replace(one, budgets=tuple(replace(b, failure=None) for b in one.budgets), findings=()) for one in passing
    ]
    many = [budget(f"holds {n}", 2.0, timeline=waves()) for n in range(10)]
    page = opened(*passing[:6], report(*many, broken(), name="bad"), *passing[6:], folded=True, width=1400)
    assert page.evaluate("document.documentElement.scrollHeight") <= 3 * SCREEN
    opened_ = page.locator("details[open]").evaluate_all("all => all.map((one) => one.parentElement.id)")
    assert opened_ == ["c7", "c7b11"]  # only the case and its budget
    top = page.locator("#c7b11").bounding_box()
    assert top is not None and top["y"] < SCREEN / 2
    page.locator("header a").click()
    assert page.evaluate("location.hash") == "#c7b11"


def test_a_link_to_a_budget_unfolds_it(opened: Open) -> None:
    page = opened(report(budget("a", 1.0)), report(budget("own", 2.0, timeline=waves())), folded=True)
    assert not page.locator("#c2b1 .waves").is_visible()
    page.locator("details.table summary").click()
    page.locator("tr", has_text="by hand").get_by_role("link", name="own").click()
    page.locator("#c2b1 .waves path.wave").first.wait_for()
    assert page.locator("#c2b1:target h3").inner_text() == "own seen"


def origin(page: Page) -> float:
    """Return the instant of the run, in milliseconds, at which the waves have their 0."""
    return page.locator(".timeline").first.evaluate("figure => Number(figure.timeline.origin)") / MS


def test_buttons_and_keys_move_the_waves_between_violations(opened: Open) -> None:
    page = opened(report(broken()))
    violation, now = page.locator(".told"), page.locator(".overtime .now")
    assert origin(page) == 4 and now.evaluate("now => now.style.left") == "4%"
    page.get_by_role("button", name="next violation").click()
    assert (
        violation.inner_text()
        == "violation 3 of 3: 20 us at 0.005000 s; its waves are not kept, those below are of another"
    )
    page.keyboard.press("n")  # goes from the last to the first
    assert violation.inner_text() == "violation 1 of 3: 30 us at 0.002000 s"
    assert origin(page) == 2 and now.evaluate("now => now.style.left") == "2%"
    assert "violation 1 of 3" in page.locator(".timeline figcaption").inner_text()
    page.keyboard.press("n")
    assert violation.inner_text().startswith("violation 2 of 3: 40 us") and origin(page) == 4
    page.keyboard.press("p")
    assert origin(page) == 2
    field = page.locator(".overtime .field").bounding_box()
    page.mouse.click(field["x"] + 0.0401 * field["width"], field["y"] + 10)
    assert violation.inner_text().startswith("violation 2 of 3")
    page.locator(".protocol input").fill("n")  # a letter of the text, not the key `n`
    assert violation.inner_text().startswith("violation 2 of 3")


def view(page: Page) -> tuple[float, float]:
    first, last = page.locator(".timeline").first.evaluate("figure => [figure.timeline.from, figure.timeline.to]")
    return first / US, last / US


def test_a_click_on_a_row_of_the_protocol_moves_the_waves_to_it(opened: Open) -> None:
    page = opened(report(broken()))
    rows = page.locator(".protocol tbody tr")
    assert [" ".join(row.split()) for row in rows.all_inner_texts()] == [
        "-90.000 us RX 01 FF error",
        "-15.000 us I2C START 0x68 W ACK 1D NACK",
        "60.000 us I2C Sr 0x68 R ACK 12 ACK 34 NACK STOP",
    ]
    assert page.locator(".protocol tr.inview").count() == 1
    assert page.locator(".protocol small.wrong").all_inner_texts() == [
        "error",
        "NACK",
    ]  # the NACK ending a read is right
    rows.nth(2).click()
    assert view(page) == (60 - 18, 180 + 18)
    assert page.locator(".protocol tr.inview").all_inner_texts() == [rows.nth(2).inner_text()]
    page.locator(".protocol input").fill("0x68 w")
    assert [row.is_visible() for row in rows.all()] == [False, True, False]
    assert page.locator(".protocol .count").inner_text() == "1 of 3 rows"


def test_a_click_on_the_strip_above_the_waves_moves_them(opened: Open) -> None:
    page = opened(report(broken()))
    strip = page.locator(".minimap").bounding_box()
    page.mouse.click(strip["x"] + strip["width"] / 2, strip["y"] + 12)  # the middle of -100 us to 200 us
    first, last = view(page)
    assert (first + last) / 2 == pytest.approx(50, abs=1) and last - first == pytest.approx(50)
    window = page.locator(".minimap .view")
    assert float(window.get_attribute("x") or 0) == pytest.approx(1000 * (first + 100) / 300, abs=1)


def test_lanes_of_the_explanation_are_shown_until_all_are_requested(opened: Open) -> None:
    timeline = waves()
    for _, lanes in timeline.groups:
        for lane in lanes:
            lane.chosen = lane.name in ("LINE", "span")
    page = opened(report(replace(broken(), timeline=timeline)))
    shown = page.locator(".stage text.name")
    assert [text.partition("LINE")[1] or text for text in shown.all_text_contents()] == ["LINE", "spanspan"]
    page.get_by_role("button", name="all lanes (2 more)").click()
    assert shown.count() == 4
    page.get_by_role("button", name="all lanes").click()
    assert shown.count() == 2


@pytest.mark.parametrize("width", [400, 1400])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_overflows_and_waves_have_contrast(small: CaseReport, opened: Open, width: int, scheme: str) -> None:
    count = "1,234,567 of 3,000,000 phases"
    at = budget("covered", 9_876.543).verdict, "phases 12.3456789 to 98.7654321 ms"
    message = PhasesReport(f"some_folder/coverage/{'long_name_' * 9}.json: 11 budgets held at {count}", count, {})
    covered = replace(small, coverage=message, budgets=tuple(replace(one, at_phases=at) for one in small.budgets))
    page = opened(covered, report(broken()), width=width, color_scheme=scheme)
    page.evaluate("document.querySelectorAll('details').forEach(one => one.open = true)")
    assert page.locator(".at-phases").count() == page.locator("td[data-name='at phases']:not(:empty)").count() > 5
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    over = """() => [...document.querySelectorAll("main *:not(svg *)")].filter((one) => {
        const box = one.getBoundingClientRect();
        return box.width && box.right > innerWidth + 1 && !one.closest(".scroll, .sr");
    }).map((one) => one.outerHTML.slice(0, 80))"""
    assert page.evaluate(over) == []
    colours = """() => [getComputedStyle(document.querySelector(".wave")).stroke,
        getComputedStyle(document.body).backgroundColor].map((text) => text.match(/\\d+/g).slice(0, 3).map(Number))"""
    wave, paper = page.evaluate(colours)
    assert contrast(wave, paper) >= 4.5


def contrast(one: list[int], other: list[int]) -> float:
    """Return the contrast ratio of WCAG 2.2."""

    def luminance(colour: list[int]) -> float:
        parts = [c / 255 / 12.92 if c <= 10 else ((c / 255 + 0.055) / 1.055) ** 2.4 for c in colour]
        return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2]

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("width", [950, 1280])
def test_the_waves_of_the_first_failure_are_visible_without_scrolling(
    small: CaseReport, opened: Open, width: int
) -> None:
    page = opened(small, width=width, folded=True)
    box = page.locator(".stage").first.bounding_box()
    assert box is not None and box["y"] + box["height"] < 950


@pytest.mark.parametrize("width", [950, 1400])
def test_the_waves_of_the_first_of_several_failing_cases_are_visible_without_scrolling(
    small: CaseReport, opened: Open, width: int
) -> None:
    source = SourceLines("a.py:7", 7, tuple((n, f"line {n}") for n in range(5, 10)))
    what = Failure(
        "40.000 us is over its limit of 10.000 us", "All are beyond", "Most of it went into", "a.py:7", source
    )
    budgets = tuple(replace(one, failure=one.failure and what) for one in small.budgets)
    cases = [replace(small, name=f"case {n}", findings=("it has no baseline",), budgets=budgets) for n in range(6)]
    page = opened(*cases, width=width, folded=True)
    assert page.locator("header .failures li").count() >= 3
    box = page.locator(".stage").first.bounding_box()
    assert box is not None and box["y"] + 355 < 950, "355 pixels are twelve lanes"
    lines = page.locator(".source-lines").first.bounding_box()
    assert lines is not None and lines["y"] > box["y"], "the firmware's lines are below the waves"


def test_a_wrong_byte_is_marked_with_the_expected_one_in_waves_and_protocol(opened: Open) -> None:
    timeline = drawn()
    boxes = Lane("boxes", "bytes", at=[0, 10 * US], end=[9 * US, 19 * US], strong=[1, 0])
    boxes.labels = boxes.says = ["0x12 not 0x11", "0x13"]
    row = Row(0, 20 * US, "I2C", "START", "0x68", "R", "ACK", (("12", "ACK", "11"), ("13", "NACK", "")), True)
    timeline = replace(timeline, groups=(("I2C bus", (boxes,)),), rows=(row,))
    page = opened(report(budget("late", 12.0, timeline=timeline)))
    assert page.locator(".box.wrong").count() == 1 and page.locator(".box").count() == 2
    assert page.locator("text.wrong").text_content() == "0x12 not 0x11"
    page.evaluate("document.querySelector('.timeline').timeline.show(-40 * 3000, 40 * 3000)")
    assert page.locator("text.wrong").text_content() == "12 not 11"
    bytes_ = page.locator(".protocol tbody td").nth(3)
    assert bytes_.inner_text().split() == ["12", "not", "11", "ACK", "13", "NACK", "STOP"]
    assert bytes_.locator(".wrong").first.inner_text() == "12 not 11 ACK"

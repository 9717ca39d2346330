"""The page in a real browser: use with mouse and keyboard, in a narrow window, and on paper."""

from __future__ import annotations

from dataclasses import replace

import pytest
from playwright.sync_api import Locator, Page

from periph_sim.interfaces.reports.html.gather import CaseReport
from tests.interfaces.reports.html.conftest import Open
from tests.interfaces.reports.html.made import US, budget, drawn, report


class ShownTimeline:
    """A timeline of a page. Places are given as a lane's name and microseconds."""

    def __init__(self, page: Page, number: int = 0, within: str = "body") -> None:
        self.page = page
        self.figure = page.locator(f"{within} .timeline").nth(number)
        self.svg = self.figure.locator(".stage > svg")
        self.tip = self.figure.locator(".tip")
        self.svg.scroll_into_view_if_needed()

    def view(self) -> tuple[float, float]:
        """Return the begin and the end of the visible part in microseconds."""
        first, last = self.figure.evaluate("figure => [figure.timeline.from, figure.timeline.to]")
        return round(first / US, 4), round(last / US, 4)

    def place(self, lane: str, us: float) -> tuple[float, float]:
        """Return a position on the screen, found as a person does, from the axis marks and the lane's name."""
        numbers = "(text) => [parseFloat(text.textContent), +text.getAttribute('x')]"
        marks = self.svg.evaluate(f"svg => [...svg.querySelectorAll('text.axis')].map({numbers})")
        (first, x0), (last, x1) = marks[0], marks[-1]
        box = self.svg.bounding_box()
        name = self.svg.locator("text.name", has_text=lane).bounding_box()
        assert box is not None and name is not None
        return box["x"] + x0 + (us - first) * (x1 - x0) / (last - first), name["y"] + name["height"] / 2

    def hover(self, lane: str, us: float) -> str:
        self.page.mouse.move(*self.place(lane, us))
        return self.tip.inner_text() if self.tip.is_visible() else ""

    def click(self, lane: str, us: float) -> None:
        self.page.mouse.click(*self.place(lane, us))

    def below(self) -> str:
        return self.figure.locator(".range").inner_text()

    def press(self, *keys: str) -> None:
        for key in keys:
            self.svg.press(key)


@pytest.fixture
def shown(opened: Open) -> ShownTimeline:
    return ShownTimeline(opened(report(budget("late", 5.0, timeline=drawn()))))


def names(table: Locator) -> list[str]:
    return [row.inner_text() for row in table.locator("td[data-name=budget]").all() if row.is_visible()]


def test_a_run_shows_its_verdicts_plots_and_timelines(small: CaseReport, opened: Open) -> None:
    page = opened(small)
    assert page.locator("tbody tr").count() >= 6
    assert names(page.locator(".verdicts"))[:2] == ["<script>alert(1)</script>", "misspelt"]  # broken ones first
    assert page.locator(".plot svg .bar").count() > 5
    assert page.locator(".timeline").count() == 4
    for number in range(4):
        assert page.locator(".timeline").nth(number).locator("path.wave").count() >= 2
    assert page.locator("#c1b5 .none").inner_text() == "No occurrence, so there is no timeline."
    assert "no event matched 'span modle begin'; did you mean model?" in page.locator("#c1b6").inner_text()


@pytest.fixture
def table(opened: Open) -> Locator:
    page = opened(report(*(budget(name, worst) for name, worst in (("b", 9.0), ("c", 10.5), ("a", 2.0)))))
    return page.locator(".verdicts")


def test_a_click_sorts_the_table_and_a_second_one_reverses_it(table: Locator) -> None:
    assert names(table) == ["c", "b", "a"]  # the broken one first
    title = table.locator("th").get_by_role("button", name="seen")
    title.click()
    assert names(table) == ["a", "b", "c"]
    title.click()
    assert names(table) == ["c", "b", "a"]
    table.get_by_role("button", name="budget").click()
    assert names(table) == ["a", "b", "c"]
    assert table.locator("th[aria-sort]").count() == 1


def test_the_table_filters_by_verdict_and_by_a_word(table: Locator) -> None:
    table.get_by_role("button", name="broken 1").click()
    assert names(table) == ["c"]
    table.get_by_role("button", name="all 3").click()
    table.locator("input").fill("why a")
    assert names(table) == ["a"]
    table.locator("input").fill("no such thing")
    assert names(table) == [] and table.locator(".none").is_visible()


def test_hovering_shows_an_event_and_its_exact_time(shown: ShownTimeline) -> None:
    message = shown.hover("LINE", -10)
    assert "LINE fell" in message and "held low by dsp" in message
    assert "12.335000 ms" in message  # 10 us before 12.345 ms
    assert "-10.000 us, 1500 cycles before" in message
    assert "15.000 us (2250 cycles)" in message  # to the next edge
    message = shown.hover("REG", 2)
    assert (
        "write of REG" in message and "at main:4" in message and "12.347000 ms" in message and "300 cycles" in message
    )
    message = shown.hover("RXFFST", 20)
    assert "RXFFST became 4" in message and "195.000 us (29250 cycles)" in message
    message = shown.hover("LINE", 8)
    assert "LINE high" in message and "10.000 us (1500 cycles)" in message
    assert "span work at main:7" in message  # the activity of the firmware at this time
    assert shown.hover("REG", 20) == ""


def test_wheel_buttons_and_keys_change_the_visible_part(shown: ShownTimeline) -> None:
    assert shown.view() == (-20, 30)
    shown.figure.get_by_role("button", name="zoom in").click()
    assert shown.view() == (-7.5, 17.5)
    shown.figure.get_by_role("button", name="reset").click()
    x, y = shown.place("LINE", 0)
    shown.page.mouse.move(x, y)
    shown.page.keyboard.down("Control")
    shown.page.mouse.wheel(0, -100)
    shown.page.keyboard.up("Control")
    first, last = shown.view()
    assert (round(last - first), round(first, 1)) == (40, -16)  # four fifths, around the pointer
    shown.press("0", "-")
    assert shown.view() == (-45, 55)
    shown.press("9")
    assert shown.view() == (-100, 200)
    shown.press("-", "-")
    assert shown.view() == (-100, 200)  # the whole timeline is visible
    assert "12.245000 ms to 12.545000 ms, 300.000 us" in shown.below()


def test_the_wheel_scrolls_the_page_until_the_timeline_is_clicked(opened: Open) -> None:
    shown = ShownTimeline(opened(report(*(budget(name, 5.0, timeline=drawn()) for name in "abcd"))))
    shown.page.mouse.move(*shown.place("LINE", 0))
    before = shown.page.evaluate("scrollY")
    shown.page.mouse.wheel(0, 100)
    shown.page.wait_for_function(f"scrollY > {before}")
    assert shown.view() == (-20, 30)
    shown.svg.scroll_into_view_if_needed()
    shown.click("LINE", 0)
    shown.page.mouse.wheel(0, -100)
    first, last = shown.view()
    assert round(last - first) == 40


def test_dragging_moves_the_view_with_the_pointer(shown: ShownTimeline) -> None:
    shown.page.mouse.move(*shown.place("LINE", 10))
    shown.page.mouse.down()
    shown.page.mouse.move(*shown.place("LINE", 0))
    shown.page.mouse.up()
    first, last = shown.view()
    assert first == pytest.approx(-10, abs=0.2) and last - first == pytest.approx(50)
    assert "A " not in shown.below()  # a drag is not a click


def test_two_clicks_measure_the_time_between_the_nearest_events(shown: ShownTimeline) -> None:
    shown.click("LINE", -9.9)
    shown.click("LINE", 5.1)
    message = shown.below()
    assert "A 12.335000 ms (-10.000 us)" in message
    assert "B 12.350000 ms (5.000 us)" in message
    assert "B - A 15.000 us (2250 cycles, 66.667 kHz)" in message
    assert shown.svg.locator("line.cursor").count() == 2
    shown.click("LINE", 15)  # this moves the nearer cursor
    assert "B - A 25.000 us (3750 cycles, 40.000 kHz)" in shown.below()
    shown.figure.get_by_role("button", name="no cursors").click()
    assert shown.svg.locator("line.cursor").count() == 0


def test_everything_can_be_done_with_the_keyboard(shown: ShownTimeline) -> None:
    shown.press("ArrowDown")  # selects the event of the first lane nearest to the middle
    assert "moved" in shown.tip.inner_text() and "12.350000 ms" in shown.tip.inner_text()
    shown.press("a", "ArrowRight", "b")
    assert "B - A 10.000 us (1500 cycles" in shown.below()
    shown.press("ArrowDown", "ArrowDown", "ArrowDown")
    assert "write of REG" in shown.tip.inner_text()
    shown.press("Shift+ArrowRight")
    assert shown.view() == (-7.5, 42.5)


def test_escape_removes_the_text_and_then_the_cursors(shown: ShownTimeline) -> None:
    shown.press("ArrowDown", "a", "ArrowRight", "b")
    shown.press("Escape")
    assert not shown.tip.is_visible() and shown.svg.locator("line.cursor").count() == 2
    shown.press("Escape")
    assert shown.svg.locator("line.cursor").count() == 0


def test_groups_of_lanes_can_be_hidden(shown: ShownTimeline) -> None:
    lanes = shown.svg.locator("text.name")
    assert lanes.count() == 4
    shown.figure.get_by_role("button", name="accesses").click()
    assert lanes.count() == 3 and "REG" not in shown.svg.text_content()


def test_markup_in_labels_is_shown_as_text(shown: ShownTimeline) -> None:
    shown.figure.get_by_role("button", name="zoom in").click()
    assert shown.svg.locator("text", has_text="<b>").count() == 1
    assert shown.svg.locator("b").count() == 0


def test_the_measured_response_is_as_long_as_in_its_verdict(small: CaseReport, opened: Open) -> None:
    """The edges of SCL at the ends of the shaded occurrence are as far apart as the budget measured."""
    shown = ShownTimeline(opened(small), within="#c1b1")
    shown.click("SCL", 0)
    shown.click("SCL", 5)
    response = next(one for one in small.budgets if one.verdict.name == "response")
    assert response.verdict.worst == 5.0
    assert "B - A 5.000 us (750 cycles, 200.000 kHz)" in shown.below()


def test_a_step_of_the_explanation_sets_a_cursor_in_the_timeline(small: CaseReport, opened: Open) -> None:
    shown = ShownTimeline(opened(small), within="#c1b1")
    chain = small.budgets[0].explanation
    shown.page.locator("#c1b1 [data-go]").first.click()
    assert f"({chain.figure(chain.steps[0].at)})" in shown.below()


def test_a_narrow_window_needs_no_horizontal_scrolling(small: CaseReport, opened: Open) -> None:
    width = 400
    page = opened(small, width=width)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    shown = ShownTimeline(page)
    assert "SCL" in shown.hover("SCL", 0)
    tip = shown.tip.bounding_box()
    assert tip is not None and tip["x"] >= 0 and tip["x"] + tip["width"] <= width
    page.locator(".verdicts th").get_by_role("button", name="seen").click()
    assert names(page.locator(".verdicts"))[0] == "misspelt"  # never measured


@pytest.mark.parametrize("width", [700, 961, 1000, 1190, 1241])
def test_a_table_with_all_columns_fits_its_window(opened: Open, width: int) -> None:
    one = budget("model execution in the worst of all cases", 123456.789)
    verdict = replace(one.verdict, why="computation of three sensor models, from one edge of a pin to the other")
    expected = report(
        replace(one, verdict=verdict, source="dissertation section 5.4: about 250 us"), name="captured_master"
    )
    page = opened(expected, expected, width=width)
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_the_colour_scheme_follows_the_browser_and_paper_is_always_light(small: CaseReport, opened: Open) -> None:
    def paper(page: Page) -> str:
        return page.evaluate("getComputedStyle(document.body).backgroundColor")

    assert paper(opened(small, color_scheme="light")) == "rgb(255, 255, 255)"
    page = opened(small, color_scheme="dark")
    assert paper(page) != "rgb(255, 255, 255)"
    page.emulate_media(media="print", color_scheme="dark")
    assert paper(page) == "rgb(255, 255, 255)"
    assert not page.locator(".timeline .tools").first.is_visible()
    assert page.locator(".timeline path.wave").first.is_visible()


def test_the_text_beside_an_event_is_within_the_window(opened: Open) -> None:
    shown = ShownTimeline(opened(report(*(budget(name, 5.0, timeline=drawn()) for name in "ab"))), 1)
    shown.page.set_viewport_size({"width": 700, "height": 500})
    shown.svg.scroll_into_view_if_needed()
    for us in (-10, 0, 29):
        assert shown.hover("RXFFST", us)
        tip, stage = shown.tip.bounding_box(), shown.figure.locator(".stage").bounding_box()
        assert tip is not None and stage is not None
        assert stage["x"] - 1 <= tip["x"] and tip["x"] + tip["width"] <= stage["x"] + stage["width"] + 1

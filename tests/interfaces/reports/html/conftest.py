"""Pages in a headless Chromium. An error, a dialog or a request of a page fails its test."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

from periph_sim.interfaces.reports.html.gather import CaseReport
from periph_sim.interfaces.reports.html.page import page
from tests.interfaces.reports.html.made import small_report

Open = Callable[..., Page]


@pytest.fixture(scope="session")
def small(tmp_path_factory: pytest.TempPathFactory) -> CaseReport:
    return small_report(tmp_path_factory.mktemp("small"))


@pytest.fixture
def opened(browser: Browser, tmp_path: Path) -> Iterator[Open]:
    """Return a function that opens a page of reports, unfolded by default. An error of the page fails the test."""
    wrong: list[str] = []
    pages: list[Page] = []

    def open_page(*reports: CaseReport, width: int = 1280, folded: bool = False, **more: object) -> Page:
        file = tmp_path / "report.html"
        file.write_text(page(reports, "a report"), encoding="utf-8")
        shown = browser.new_page(viewport={"width": width, "height": 900}, **more)
        shown.on("console", lambda message: wrong.append(f"console: {message.text}"))
        shown.on("pageerror", lambda error: wrong.append(f"error: {error}"))
        shown.on("dialog", lambda dialog: (wrong.append(f"dialog: {dialog.message}"), dialog.dismiss()))
        shown.on("request", lambda asked: asked.url != file.as_uri() and wrong.append(f"request: {asked.url}"))
        shown.goto(file.as_uri())
        if not folded:
            shown.evaluate("document.querySelectorAll('details').forEach((one) => (one.open = true)); unfold()")
        pages.append(shown)
        return shown

    yield open_page
    for shown in pages:
        shown.close()
    assert not wrong

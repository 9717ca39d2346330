"""Explanations on the page: a Chain made by hand, and what is told of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import Element

import html5lib

from periph_sim.core.time import Timebase
from periph_sim.interfaces.reports.explain.chain import Chain, FirmwarePlace, Part, Step
from periph_sim.interfaces.reports.html.page import page
from tests.interfaces.reports.html.made import US, budget, report

RESPONSE = budget("response", 8.0)
PLACE = FirmwarePlace("batch_read", 98, Path("/home/somebody/imu_hil.py"))


def told(chain: Chain) -> tuple[list[list[Element]], list[str]]:
    """The rows of the tables of an explanation, and the quiet sentences beside them."""
    text = page([report(replace(RESPONSE, explanation=chain))], "by hand")
    root = html5lib.HTMLParser(strict=True, namespaceHTMLElements=False).parse(text)
    tables = root.findall(".//table[@class='chain']")
    return [table.findall("./tbody/tr") for table in tables], [one.text for one in root.findall(".//p[@class='quiet']")]


def cells(row: Element) -> list[str]:
    return ["".join(cell.itertext()) for cell in row]


def test_steps_and_shares_are_told_with_their_places_but_not_with_folders() -> None:
    (steps, shares), quiet = told(
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
        ["75.0 %", "6.000 us", "", f"SCIRXINTA in 3 times {place} +3.000 us against typical"],
        ["25.0 %", "2.000 us", "", "wait for AAS"],  # a third of a nanosecond less is not worth a word
    ]
    assert "The least remarkable occurrence took 5.000 us." in quiet


def test_an_occurrence_without_length_has_no_shares() -> None:
    tables, quiet = told(Chain(RESPONSE.verdict, Timebase(150_000_000), 0, ()))
    assert (tables, [text for text in quiet if "least remarkable" in text]) == ([], [])

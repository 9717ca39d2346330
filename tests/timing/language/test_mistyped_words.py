"""Mistyped words in measures whose remaining text is correct."""

from __future__ import annotations

import pytest

from periph_sim.timing.language.language import measure_of, near_form
from periph_sim.timing.language.scope import BadEvent
from tests.scene.small import sentence_of


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("each time in flah PIE.PIEACK.PIEACK = 128", "'flah' where flag is expected; a span's name is quoted"),
        ("time in Wire SCL low", "'Wire' where wire is expected; a span's name is quoted"),
        ("share of time in varible count = 3", "'varible' where variable is expected; a span's name is quoted"),
        ("each time in interupt SCIRXINTA", "'interupt' where interrupt is expected; a span's name is quoted"),
        ("time in buss busy", "'buss' where bus is expected; a span's name is quoted"),
        ("time in cup idle", "'cup' where cpu is expected; a span's name is quoted"),
        ("time in cpu bussy", "'bussy' where busy or idle is expected; did you mean busy?"),
    ],
)
def test_a_mistyped_state_is_not_read_as_a_span(text: str, sentence: str) -> None:
    assert sentence_of(BadEvent, lambda: measure_of(text)) == f"{text!r}: {sentence}"


@pytest.mark.parametrize(
    "span", ["write page", "flash", "'write high'", "wait low", "span flah A = 1", "interrupts on"]
)
def test_the_name_of_a_span_can_resemble_a_state(span: str) -> None:
    state = measure_of(f"each time in {span}").state
    assert [event.kind for event in (*state.enters, *state.leaves)] == ["span", "span"]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("value error of gyroscope a frame", "'a' where at or the end is expected"),
        ("level of I2C-A.I2CSTR.BB t bus START", "'t' where at or the end is expected"),
        ("cpu load f dsp", "'f' where of or the end is expected"),
        ("bus load pr 20 ms", "'pr' where per or the end is expected"),
        ("count of bus START form bus START to bus STOP", "'form' where from or the end is expected"),
        ("stack high-water of dsp it", "'it' is more than a measure or event says; leave it out"),
    ],
)
def test_a_mistyped_optional_word_is_named(text: str, sentence: str) -> None:
    assert sentence_of(BadEvent, lambda: measure_of(text)) == f"{text!r}: {sentence}"


@pytest.mark.parametrize(("text", "form"), [("COUNT of bus STOP", "count of EVENT"), ("Slack", "slack")])
def test_a_form_in_the_wrong_case_is_suggested(text: str, form: str) -> None:
    assert near_form(text) == form

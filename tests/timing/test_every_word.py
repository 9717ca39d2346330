"""Each word that makes a measure: an example on a page that is run, a test by another way, and its nearest misuse."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import pytest

from periph_sim.timing.language.language import FORMS
from periph_sim.timing.language.scope import BadEvent
from periph_sim.timing.measures.factory import measure_named
from periph_sim.timing.measures.registry import MEASURES
from tests.docs.pages import ROOT
from tests.scene import test_event_budgets, test_image_budgets, test_master_with_eeprom
from tests.scene.small import sentence_of
from tests.timing import (
    test_age,
    test_derived_values,
    test_loads,
    test_margins,
    test_model_age,
    test_pairs,
    test_rounds,
)
from tests.timing.events_by_hand import BARE, ONE
from tests.timing.measures import (
    test_groups,
    test_states,
)
from tests.timing.measures import (
    test_race as test_race_measures,
)
from tests.timing.measures import (
    test_value as test_value_measures,
)
from tests.timing.measures.test_event import EXAMPLES, IMAGE

ANOTHER_WAY: dict[str, Callable[..., None]] = {
    "from": test_pairs.test_in_order_is_a_queue,
    "period": test_event_budgets.test_each_budget_equals_the_measure_of_the_recorded_run,
    "jitter": test_groups.test_jitter_of_a_measure_is_from_value_to_value,
    "count": test_pairs.test_a_count_between_is_what_a_walk_over_the_records_gives,
    "sum": test_derived_values.test_bytes_are_compared_as_far_as_both_go,
    "level": test_groups.test_the_fifo_at_service_routine_entry,
    "calls": test_image_budgets.test_functions_are_spans,
    "stack": test_image_budgets.test_the_deepest_stack_in_words,
    "interrupt": test_event_budgets.test_each_budget_equals_the_measure_of_the_recorded_run,
    "reaction": test_rounds.test_reaction_is_from_the_last_flag_before_each_write,
    "busy": test_master_with_eeprom.test_the_busy_time_equals_that_of_the_acknowledges_of_a_recorded_run,
    "gap": test_rounds.test_round_slack_and_gap_are_those_of_the_recorded_bytes,
    "margin": test_margins.test_it_is_the_time_to_the_controllers_release_less_what_the_module_takes,
    "SCL": test_rounds.test_what_scl_is_held_for_is_the_sum_of_a_transfers_lows,
    "time": test_states.test_a_sum_is_what_a_count_tick_by_tick_gives,
    "each": test_states.test_in_a_run_states_and_their_opposites_fill_the_time,
    "share": test_loads.test_the_busiest_window_is_what_a_count_tick_by_tick_gives,
    "cpu": test_loads.test_the_busiest_window_is_what_a_count_tick_by_tick_gives,
    "bus": test_loads.test_the_busiest_window_is_what_a_count_tick_by_tick_gives,
    "slack": test_rounds.test_round_slack_and_gap_are_those_of_the_recorded_bytes,
    "race": test_race_measures.test_a_budget_finds_what_the_recording_shows,
    "lost": test_race_measures.test_a_flag_lost_to_a_read_modify_write_breaks_its_budget,
    "cleared": test_race_measures.test_a_flag_that_was_read_but_not_looked_at_is_lost_and_cleared_along,
    "age": test_age.test_an_age_never_falls_but_by_a_younger_frame,
    "model": test_model_age.test_where_chips_show_the_frames_values_it_is_their_age,
    "value": test_value_measures.test_it_is_the_age_times_how_fast_the_truth_moves,
}
MISUSE = {
    "from": ("from frame RX to frame TX in turn", "'turn' where order is expected"),
    "period": ("period bus START", "'bus' where of is expected"),
    "jitter": ("jitter of cpu load", "that is one number a run, so it has no jitter"),
    "count": ("count of bus NACK byt", "'byt' is more than a measure or event says"),
    "sum": ("sum of record data wrong byte", "'wrong' where bytes asked, "),
    "level": ("level of SCI-A.SCIFFRX at frame", "'SCI-A.SCIFFRX' is no field"),
    "calls": ("calls _isr", "'_isr' where of is expected"),
    "stack": ("stack highwater", "'highwater' where high-water is expected"),
    "interrupt": ("interrupt latency SCIRXINTA to access", "'access' where first is expected"),
    "reaction": ("reaction of dps", "there is no unit 'dps'; did you mean dsp?"),
    "busy": ("busy time of eeprom", "the address of a memory is expected after of"),
    "gap": ("gap between round", "'round' where rounds is expected"),
    "margin": ("margin of I2CDRR", "only I2CDXR has a margin; write margin of I2CDXR"),
    "SCL": ("SCL held by dsp", "'by' where per is expected"),
    "time": ("time in flag I2C-A.I2CSTR.BB", "ends where = is expected"),
    "each": ("each in model", "'in' where time is expected"),
    "share": ("share of any 20 in cpu busy", "'20' has no unit; write for instance 20 ms"),
    "cpu": ("cpu load per 20", "'20' has no unit; write for instance 20 ms"),
    "bus": ("bus load per 0 ms", "a window is longer than 0"),
    "slack": ("slack of round", "'of' is more than a measure or event says; leave it out"),
    "race": ("race I2C-A.I2CSTR.XRDI", "I2CSTR has no field 'XRDI'"),
    "lost": ("lost flag", "'flag' where flags is expected"),
    "cleared": ("cleared I2C-A.I2CSTR.SDIR", "'I2C-A.I2CSTR.SDIR' where along is expected"),
    "age": ("age of gyro", "'gyro' where gyroscope, accelerometer or magnetometer is expected"),
    "model": ("model of gyroscope", "'of' where age is expected"),
    "value": ("value error of gyroscope at frames", "'frames' where first or frame is expected"),
}
PARTS = ("last frame RX end of burst", "2nd bus byte of transfer", "bus NACK", "frame TX", ", in order", "per 20 ms")


def examples() -> Iterator[str]:
    """Every measure in the files that a page writes, and in the cases that one runs."""
    measure = re.compile(r'measure ?= ?"([^"]+)"')
    for page in [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]:
        text = page.read_text(encoding="utf-8")
        for file in re.findall(r"^<!-- file: \S+ -->\n```\w+\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
            yield from measure.findall(file)
        for path in set(re.findall(r"^\$ periph-sim \w+ (timing/\w+\.toml)", text, re.MULTILINE)):
            yield from measure.findall((ROOT / path).read_text(encoding="utf-8"))


SHOWN = list(examples())


@pytest.mark.parametrize("form", FORMS)
def test_each_form_is_run_on_a_page(form: str):
    assert any(text.split()[0] == form for text in SHOWN)


@pytest.mark.parametrize("name", MEASURES)
def test_each_name_is_run_on_a_page(name: str):
    assert name in SHOWN


@pytest.mark.parametrize("part", PARTS)
def test_each_way_to_say_which_is_run_on_a_page(part: str):
    assert any(part in text for text in SHOWN)


def test_each_form_is_worked_out_another_way():
    assert list(ANOTHER_WAY) == list(FORMS)


@pytest.mark.parametrize("form", FORMS)
def test_each_form_tells_its_nearest_misuse(form: str):
    text, said = MISUSE[form]
    assert text.split()[0] == form
    assert said in sentence_of(BadEvent, lambda: measure_named(text, ONE))


def test_six_classes_measure_what_no_sentence_can_say():
    texts = [*EXAMPLES, *MEASURES, "span:x", "reply:x", "silence:x", "watch:x"]
    made = {type(measure_named(text, IMAGE)).__name__ for text in texts}
    of_sentences = {"EventMeasure", "Between", "TimeIn"}
    assert made - of_sentences == {"Margin", "Race", "LostFlags", "Reply", "Unsolicited", "WatchedWire"}


def test_rounds_need_to_be_known():
    with pytest.raises(BadEvent, match=r"needs \[controller\] or \[rounds\] in the scene"):
        measure_named("gap between rounds", BARE)

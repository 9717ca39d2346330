"""Each form of a measure has an example on a tested page, a test by a second computation, and a test of its misuse."""

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

SECOND_COMPUTATION: dict[str, Callable[..., None]] = {
    "from": test_pairs.test_in_order_is_a_queue,
    "period": test_event_budgets.test_each_budget_equals_the_measure_of_the_recorded_run,
    "jitter": test_groups.test_the_jitter_of_a_measure_is_the_difference_of_consecutive_values,
    "count": test_pairs.test_a_count_between_agrees_with_a_loop_over_the_records,
    "sum": test_derived_values.test_bytes_are_compared_up_to_the_shorter_length,
    "level": test_groups.test_the_level_of_the_fifo_at_the_entry_of_its_service_routine,
    "calls": test_image_budgets.test_functions_are_spans,
    "stack": test_image_budgets.test_the_deepest_stack_in_words,
    "interrupt": test_event_budgets.test_each_budget_equals_the_measure_of_the_recorded_run,
    "reaction": test_rounds.test_reaction_is_from_the_last_flag_before_each_write,
    "busy": test_master_with_eeprom.test_the_busy_time_equals_that_of_the_acknowledges_of_a_recorded_run,
    "gap": test_rounds.test_round_slack_and_gap_agree_with_the_recorded_bytes,
    "margin": test_margins.test_the_margin_is_the_time_to_the_release_by_the_controller_minus_that_of_the_module,
    "SCL": test_rounds.test_the_time_scl_is_held_is_the_sum_over_the_low_phases_of_a_transfer,
    "time": test_states.test_a_sum_agrees_with_a_count_of_ticks,
    "each": test_states.test_times_in_a_state_and_in_its_opposite_add_up_to_the_run,
    "share": test_loads.test_the_busiest_window_agrees_with_a_count_of_ticks,
    "cpu": test_loads.test_the_busiest_window_agrees_with_a_count_of_ticks,
    "bus": test_loads.test_the_busiest_window_agrees_with_a_count_of_ticks,
    "slack": test_rounds.test_round_slack_and_gap_agree_with_the_recorded_bytes,
    "race": test_race_measures.test_a_budget_on_races_agrees_with_the_recording,
    "lost": test_race_measures.test_a_flag_lost_to_a_read_modify_write_breaks_its_budget,
    "cleared": test_race_measures.test_a_flag_read_only_along_with_another_is_lost_and_cleared_along,
    "age": test_age.test_an_age_decreases_only_with_a_newer_frame,
    "model": test_model_age.test_the_model_age_is_the_data_age_if_chips_show_values_of_frames,
    "value": test_value_measures.test_the_value_error_is_the_age_times_the_rate_of_change,
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
    """Yield every measure in the files and in the cases that are shown and run on a page of the documentation."""
    measure = re.compile(r'measure ?= ?"([^"]+)"')
    for page in [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]:
        text = page.read_text(encoding="utf-8")
        for file in re.findall(r"^<!-- file: \S+ -->\n```\w+\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
            yield from measure.findall(file)
        for path in set(re.findall(r"^\$ periph-sim \w+ (timing/\w+\.toml)", text, re.MULTILINE)):
            yield from measure.findall((ROOT / path).read_text(encoding="utf-8"))


ON_PAGES = list(examples())


@pytest.mark.parametrize("form", FORMS)
def test_each_form_is_used_on_a_page(form: str):
    assert any(text.split()[0] == form for text in ON_PAGES)


@pytest.mark.parametrize("name", MEASURES)
def test_each_name_is_used_on_a_page(name: str):
    assert name in ON_PAGES


@pytest.mark.parametrize("part", PARTS)
def test_each_way_to_select_events_is_used_on_a_page(part: str):
    assert any(part in text for text in ON_PAGES)


def test_each_form_has_a_test_by_a_second_computation():
    assert list(SECOND_COMPUTATION) == list(FORMS)


@pytest.mark.parametrize("form", FORMS)
def test_a_mistake_in_each_form_is_reported(form: str):
    text, said = MISUSE[form]
    assert text.split()[0] == form
    assert said in sentence_of(BadEvent, lambda: measure_named(text, ONE))


def test_only_six_classes_of_measures_are_not_made_of_events():
    texts = [*EXAMPLES, *MEASURES, "span:x", "reply:x", "silence:x", "watch:x"]
    made = {type(measure_named(text, IMAGE)).__name__ for text in texts}
    of_events = {"EventMeasure", "Between", "TimeIn"}
    assert made - of_events == {"Margin", "Race", "LostFlags", "Reply", "Unsolicited", "WatchedWire"}


def test_gap_between_rounds_needs_rounds():
    with pytest.raises(BadEvent, match=r"needs \[controller\] or \[rounds\] in the scene"):
        measure_named("gap between rounds", BARE)

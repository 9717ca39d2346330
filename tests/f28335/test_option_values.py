"""Values of options that are numbers or booleans: the allowed values and the defaults.

Values that are words are tested in the `test_open_...` of each option.
"""

from __future__ import annotations

import dataclasses

import pytest

from periph_sim.core.options import Value, options_from
from periph_sim.f28335.i2c.options import I2cOptions
from periph_sim.f28335.sci.options import SciOptions
from periph_sim.f28335.spi.options import SpiOptions
from periph_sim.f28335.system_options import SystemOptions

# The first is the default.
ANSWERS: dict[type, dict[str, tuple[Value, ...]]] = {
    SystemOptions: {
        "vector_fetch_waits": (0, 1, 2),
        "intr_clears_ifr": (True, False),
        "pieack_reset": (0x000, 0xFFF),
        "pf1_back_to_back_write": (1, 0),
        "write_lands": (2, 4),
        "stalls": (True, False),
        "b_unc_cycles": (7, 4),
        "push_acc_cycles": (1, 2),
        "odd_32bit_target": (1, 0),
        "saram_conflict": (0, 1),
        "rptc_width": (16, 8),
        "gpio_out_delay": (1, 0, 2),
    },
    SciOptions: {
        "start_hunt_point": (6, 7, 8),
        "rx_sync_stages": (2, 0, 3),
        "break_char_delivered": (True, False),
        "error_flags_sticky": (True, False),
        "sleep_loads_buffer": (False, True),
        "fftxdly_max": (255, 256),
        "idle_before_first_frame": (True, False),
    },
    SpiOptions: {
        "swreset_clears_fifos": (False, True),
        "spirst_clears_fifos": (True, False),
    },
    I2cOptions: {
        "emdr_present": (True, False),
        "bcm_reset": (1, 0),
        "stretch_after_address_ack": (True, False),
        "nack_clears_dxr": (False, True),
        "nackint_in_slave_tx": (True, False),
        "irs_write1_releases_bus": (False, True),
        "rrdy_clear_reads_drr": (True, False),
        "isrc_read_clears_aas": (False, True),
        "irs_clears_commands": (True, False),
        "irs_clears_isrc": (True, False),
        "ardy_on_nack": (True, False),
        "hold_scl_after_nack": (True, False),
        "al_clears_stt": (True, False),
        "txfifo_reset_flushes_xsr": (False, True),
        "irs_clears_fifo": (False, True),
    },
}

RANGES = [
    (SystemOptions, "int_latency", 14, 13, 16),
    (SystemOptions, "idle_wake", 0, 0, 16),
    (SystemOptions, "pf2_read_ws", 2, 0, 15),
    (SystemOptions, "pf2_write_ws", 0, 0, 15),
    (SciOptions, "rx_int_extra", 3, 0, 16),
    (SpiOptions, "input_latency", 0, 0, 16),
    (I2cOptions, "sda_setup_before_scl_release", 1, 0, 255),
    (I2cOptions, "event_to_isrc_delay", 2, 0, 64),
    (I2cOptions, "scl_sync_cycles", 0, 0, 16),
    (I2cOptions, "noise_filter_cycles", 1, 0, 4096),
]


@pytest.mark.parametrize("kind", ANSWERS)
def test_allowed_values_that_are_not_words(kind: type):
    found = {
        of.name: of.metadata["values"]
        for of in dataclasses.fields(kind)
        if "values" in of.metadata and not isinstance(of.default, str)
    }
    assert found == ANSWERS[kind]
    assert [type(value) for values in found.values() for value in values] == [
        type(value) for values in ANSWERS[kind].values() for value in values
    ]


@pytest.mark.parametrize("kind", ANSWERS)
def test_the_first_value_of_every_option_is_the_default(kind: type):
    for of in dataclasses.fields(kind):
        if "values" in of.metadata:
            assert kind().unrecorded()[of.name] == of.metadata["values"][0], of.name


@pytest.mark.parametrize(("kind", "name", "default", "least", "most"), RANGES)
def test_a_number_is_accepted_from_its_minimum_to_its_maximum(
    kind: type, name: str, default: int, least: int, most: int
):
    assert kind().unrecorded()[name] == default
    for value in (least, most):
        assert options_from(kind, {name: value}).unrecorded()[name] == value
    for value in (least - 1, most + 1):
        with pytest.raises(ValueError, match=f"option {name} is {value}; expected {least} to {most} "):
            options_from(kind, {name: value})


def test_every_option_with_a_range_is_in_the_table():
    ranged = {(kind, of.name) for kind in ANSWERS for of in dataclasses.fields(kind) if "least" in of.metadata}
    assert ranged == {(kind, name) for kind, name, *_ in RANGES}


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"bcm_reset": 2}, "option bcm_reset is 2; expected 1 or 0"),
        ({"bcm_reset": True}, "option bcm_reset is True; expected 1 or 0"),
        ({"emdr_present": 1}, "option emdr_present is 1; expected true or false"),
        ({"int_line": "plus"}, "option int_line is 'plus'; expected pulse or level"),
        ({"event_to_isrc_delay": "2"}, "option event_to_isrc_delay is '2'; expected 0 to 64 SYSCLKOUT cycles"),
        ({"event_to_isrc_delay": True}, "option event_to_isrc_delay is True; expected 0 to 64 SYSCLKOUT cycles"),
        ({"bcm_rest": 1}, "there is no option 'bcm_rest'; did you mean bcm_reset or emdr_present?"),
    ],
)
def test_the_error_of_a_wrong_value_names_the_allowed_ones(given: dict[str, Value], sentence: str):
    with pytest.raises(ValueError) as error:
        options_from(I2cOptions, given)
    assert str(error.value) == sentence

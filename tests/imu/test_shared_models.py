"""What several compute alike is computed once, and is what each would have computed alone."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.imu.imu_noise import ImuNoise
from periph_sim.imu.model_codes import ModelCodes, model_codes
from periph_sim.imu.models.imu import Noise
from periph_sim.imu.models.parameters import ImuParameters
from periph_sim.imu.numeric import arithmetic_names as named
from periph_sim.imu.shared_models import REMEMBERED, model_noise, model_of
from tests.profiles import examples

PARAMETERS = ImuParameters()


@settings(max_examples=examples(40), deadline=None)
@given(
    st.sampled_from(["q16", "q12 saturating", "q16 rounded", "float64"]),
    st.lists(st.tuples(*[st.integers(-32768, 32767)] * 6), max_size=8),
)
def test_a_remembered_sample_is_the_one_that_is_computed_anew(arithmetic: str, frames: list[tuple[int, ...]]):
    shared, alone = model_codes(PARAMETERS, arithmetic, None), ModelCodes(PARAMETERS, arithmetic)
    for _ in range(2):
        shown, expected = shared.at_rest, alone.at_rest
        for number, values in enumerate(frames):
            shown, expected = shared.run(number, values, shown), alone.run(number, values, expected)
            assert all(shown.data(address) == expected.data(address) for address in shared.addresses)
            assert (shown.state, shown.overflows) == (expected.state, expected.overflows)


def test_who_comes_second_is_given_what_the_first_has_worked_out():
    codes, values = model_codes(PARAMETERS, "q16", None), (100, 200, 300, 0, 0, 0)
    first = codes.run(0, values, codes.at_rest)
    assert model_codes(PARAMETERS, "q16", None) is codes
    assert codes.run(0, tuple(values), codes.at_rest) is first
    assert codes.run(1, values, codes.at_rest) is not first
    assert codes.run(0, values, first) is not first


@given(st.lists(st.integers(0, 3 * REMEMBERED), min_size=1, max_size=20), st.data())
@settings(max_examples=examples(20), deadline=None)
def test_noise_is_that_of_its_number_whoever_asks_and_in_whatever_order(asked: list[int], data: st.DataObject):
    arithmetic = data.draw(st.sampled_from(["q16", "float64"]))
    holders = [model_noise(arithmetic, PARAMETERS, 7), model_noise(arithmetic, PARAMETERS, 7)]
    constant = named.scalar(arithmetic).constant
    for number in asked:
        alone = ImuNoise(PARAMETERS, 7).at(number)
        expected = Noise(*(tuple(constant(x) for x in axes) for axes in alone))
        assert holders[data.draw(st.integers(0, 1))](number) == expected
    assert model_noise(arithmetic, PARAMETERS, None)(3) == model_of(arithmetic, PARAMETERS).silence

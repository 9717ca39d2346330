"""What several compute alike is computed once, and is what each would have computed alone."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.imu.imu_noise import ImuNoise
from periph_sim.imu.models.imu import Imu, Noise
from periph_sim.imu.models.parameters import ImuParameters
from periph_sim.imu.numeric import arithmetic_names as named
from periph_sim.imu.shared_models import REMEMBERED, model_noise, model_of
from tests.profiles import examples

PARAMETERS = ImuParameters()
numbers = st.integers(-200_000, 200_000)
triples = st.tuples(numbers, numbers, numbers)


@settings(max_examples=examples(40), deadline=None)
@given(st.sampled_from(["q16", "q12 saturating", "q16 rounded"]), st.lists(st.tuples(triples, triples), max_size=8))
def test_a_remembered_sample_is_the_one_that_is_computed_anew(arithmetic: str, samples):
    shared, alone = model_of(arithmetic, PARAMETERS), Imu(named.scalar(arithmetic), PARAMETERS)
    for _ in range(2):
        state = alone.at_rest
        for attitude, pushed in samples:
            expected = alone.step(attitude, pushed, alone.silence, state)
            assert shared.step(attitude, pushed, shared.silence, state) == expected
            state = expected[1]


def test_who_comes_second_is_given_what_the_first_has_worked_out():
    model, still = model_of("q16", PARAMETERS), (0, 0, 0)
    attitude = (100, 200, 300)
    first = model.motion(attitude, still)
    assert model_of("q16", PARAMETERS) is model
    assert model.motion((100, 200, 300), (0, 0, 0)) is first
    codes = model.codes_of("magnetometer", first[0], still, first[1], still, model.silence)
    assert codes is model.codes_of("magnetometer", first[0], still, first[1], still, model.silence)


def test_of_floats_nothing_is_remembered_since_zeros_of_two_signs_are_equal():
    model = model_of("float64", PARAMETERS)
    zero = model.a.constant(0.0)
    still = (zero, zero, zero)
    minus = model.motion((model.a.neg(zero), zero, zero), still)[0].s_phi
    assert str(minus) != str(model.motion(still, still)[0].s_phi)


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

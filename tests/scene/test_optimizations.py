"""Every shipped case gives the same records and figures whichever optimizations are off.

A read of a wait that is skipped leaves no record of its access, so records of reads are compared where polls are on.
"""

from __future__ import annotations

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.scene.case.load import load
from periph_sim.scene.case.optimizations import ALL, BITS, DECODING, OPTIMIZATIONS, POLLS, is_on
from tests.scene.runs import TIMING
from tests.scene.test_bit_skip import BUT_EDGES, Disable, figures, run

# The cases of timing/trade act in the middle of bytes and frames: resets, clock gates, spikes, reads of pads.
CASES = sorted(str(path.relative_to(TIMING))[:-5] for path in (*TIMING.glob("*.toml"), *TIMING.glob("trade/*.toml")))
IMAGES = ("imu_hil_image",)


SHORT = {"imu_hil_image": "0.0115", "imu_hil_c": "0.0077", "trade/arbitration": "0.003"}  # each poll is made


def seconds_of(name: str) -> str:
    return "0.0077" if name == "imu_hil_c" else "0.05"  # each poll of C sources is made


def without_reads(records: list[Record]) -> list[tuple[object, ...]]:
    """Return the records but for reads, without their numbers and causes."""
    return [
        record._replace(number=0, cause=0)
        for record in records
        if record.kind is not Kind.ACCESS or not record.what.startswith("R ")
    ]


@pytest.mark.parametrize("disable", [(BITS,), (DECODING,)], ids=["bits", "decoding"])
@pytest.mark.parametrize("name", CASES)
def test_every_case_gives_the_same_records_without_optimizations(name: str, disable: Disable):
    if DECODING in disable and name not in IMAGES:
        pytest.skip("it runs no image")
    case = load(TIMING / f"{name}.toml")
    default, plain = (run(case, names, BUT_EDGES, seconds_of(name)) for names in ((), disable))
    assert figures(default[0]) == figures(plain[0])
    assert default[1] == plain[1] and len(plain[1]) > 20


@pytest.mark.parametrize("name", CASES)
def test_every_case_gives_the_same_records_but_of_reads_without_any_optimization(name: str):
    case = load(TIMING / f"{name}.toml")
    default, plain = (run(case, names, BUT_EDGES, SHORT.get(name, "0.011")) for names in ((), (ALL,)))
    shown = [figures(one[0]) for one in (default, plain)]
    counts = [one["counts"].pop("polls_skipped") for one in shown]
    assert shown[0] == shown[1]
    assert counts[1] == 0
    assert without_reads(default[1]) == without_reads(plain[1]) and len(plain[1]) > 20


def test_each_name_is_known_and_switches_one_off():
    for name in OPTIMIZATIONS:
        assert not is_on(name, (name,)) and not is_on(name, (ALL,)) and is_on(name, ())
        assert all(is_on(other, (name,)) for other in OPTIMIZATIONS if other != name)


def test_a_run_without_optimizations_makes_each_edge_and_each_poll():
    case = load(TIMING / "responder.toml")
    results = [run(case, disable, (), "0.011")[0] for disable in ((), (BITS,), (POLLS,), (ALL,))]
    default, bits, polls, everything = (result.events for result in results)
    assert default < bits < everything and default < polls < everything
    assert results[3].bytes_skipped == results[3].counts["polls_skipped"] == 0

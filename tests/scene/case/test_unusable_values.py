"""Times, rates and counts of a case at both ends of their ranges, and unusable values: one message, no traceback."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim import BadCase, Scene, load
from periph_sim.interfaces.commands.command_frame import MISTAKES
from tests.scene.small import sentence_of

TIMING = Path(__file__).parents[3] / "timing"
TIMES = ("0 s", "1 ns", "1e-30 s", "365 d", "17000 d", "365250 d", "-1 us", "1e40 d", "1e999999999 s", "1e-999999999 s")
RATES = ("1/1000 Hz", "1 Hz", "1000 GHz", "1e40 GHz", "1e-999999999 kHz", "0.3333333 kHz")
COUNTS = ("0", "-1", "1", str(2**31), str(2**63 - 1), str(2**63), str(-(2**63) - 1), "9" * 4000, "9" * 5000, "1e300")
KINDS = (
    (re.compile(r"[-\d. e]+\s*(ns|us|ms|s|min|h|d)( to .*)?"), TIMES),
    (re.compile(r"[-\d. e]+\s*[kMG]?Hz"), RATES),
)
ONE_TENTH_OF_A_MS = Fraction(1, 10_000)
SMALL = """\
name = "small"
duration = "1 ms"

[controller]
order = ["gyroscope"]
"""


def values(tree: object, place: tuple[str, ...] = ()) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield each key that holds a time, a rate or a count, with the extreme values to try."""
    if isinstance(tree, dict):
        for key, value in tree.items():
            yield from values(value, (*place, key))
    elif isinstance(tree, list) and tree and isinstance(tree[0], dict):
        for number, value in enumerate(tree):
            yield from values(value, (*place, str(number)))
    elif isinstance(tree, int | float) and not isinstance(tree, bool):
        yield ".".join(place), COUNTS
    elif isinstance(tree, str):
        yield from ((".".join(place), extremes) for pattern, extremes in KINDS if pattern.fullmatch(tree))


@pytest.mark.parametrize("name", ["responder", "uart_logger", "imu_hil_spikes", "eeprom_log"])
def test_each_time_rate_and_count_at_its_ends(name: str):
    """The scene runs, or is refused with a message of the tool; no other exception is raised."""
    path = TIMING / f"{name}.toml"
    refused = ran = 0
    for key, extremes in values(tomllib.loads(path.read_text())):
        for value in extremes:
            try:
                Scene(load(path, [f"{key}={value}"])).run(ONE_TENTH_OF_A_MS)
                ran += 1
            except Exception as error:
                kinds = {f"{kind.__module__}.{kind.__qualname__}" for kind in type(error).__mro__}
                assert not MISTAKES.isdisjoint(kinds), f"{key}={value[:40]}: {error!r}"
                assert len(str(error)) < 600, f"{key}={value[:40]}: {error}"
                refused += 1
    assert refused and ran


@pytest.fixture
def small(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("small.toml").write_text(SMALL)
    return Path("small.toml")


def refusal(path: Path, *changes: str) -> str:
    return sentence_of(BadCase, lambda: load(path, list(changes)))


@pytest.mark.parametrize(
    ("line", "number", "message"),
    [
        ('period = "50 h"\njitter = 9223372036854775808', 6, "controller.jitter is an integer that does not fit 64"),
        (f"jitter = {'9' * 5000}", 5, "an integer is too long; it must fit 64 bits"),
        ('request = [{name = "a\\u001b[31mb"}]', 5, "controller.request.0.name: 'a\\x1b[31mb' is no name; a name is"),
        ('order = ["gyro\\nscope"]', 5, "controller.order.0: 'gyro\\nscope' is no name; a name is one line of"),
        ('"a\\nb" = 1', 0, "controller.a\\nb: 'a\\nb' is no name; a name is one line of printable characters"),
    ],
)
def test_a_value_that_no_case_can_use_is_refused_with_its_line(small: Path, line: str, number: int, message: str):
    small.write_text(SMALL.replace('order = ["gyroscope"]', line))
    where = f"small.toml, line {number}: " if number else "small.toml, line 4: "
    assert refusal(small).startswith(where + message)


def test_a_change_that_gives_such_a_value_is_named_and_shortened(small: Path):
    message = refusal(small, f"controller.period={'9' * 5000}")
    assert message.startswith("--set 'controller.period=999") and len(message) < 400
    assert refusal(small, "controller.period=50 d", 'name="a\\u0007b"').startswith("small.toml, --set 'name=")


def test_tables_nested_without_end_are_refused(small: Path):
    small.write_text("a = " + "[" * 5000)
    assert refusal(small).startswith("small.toml: its tables or lists are nested too deeply")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("controller.period=9 us", "controller: period is shorter than a bit of SCL, so no round can end in it"),
        ("host.period=8 us", "host: period is shorter than a bit of the line, so no frame can be sent in it"),
        ("rounds.period=999 ns", "rounds: period is shorter than 1 us, and no transfer is"),
        ("controller.period=1e7 d", "'1e7 d' is longer than 365250 d, the longest time that can be given"),
    ],
)
def test_a_period_that_is_too_short_or_too_long_is_refused(small: Path, change: str, message: str):
    assert message in refusal(small, change)


def test_a_time_that_fine_ticks_cannot_count_is_refused():
    """A crystal of 29 999 999 Hz makes ticks of 33 as, of which 64 bits count 154 s."""
    changes = ["unit.dsp.oscclk=29999999 Hz", "controller.period=500 s"]
    with pytest.raises(ValueError, match=r"a time of 500 s is too long: .* the longest is 153.7 s; a crystal of"):
        Scene(load(TIMING / "responder.toml", changes))


@pytest.mark.parametrize("key", ["controller.period", "start", "controller.first", "host.period"])
def test_a_time_that_is_too_long_is_named_with_its_key_and_change(key: str):
    change = f"{key}=18263 d"
    with pytest.raises(BadCase, match=f", --set '{change}': {key}: a time of 1826[13].* d is too long: with ticks of"):
        Scene(load(TIMING / ("imu_hil.toml" if key.startswith("host") else "responder.toml"), [change]))


def test_a_time_that_is_too_long_is_named_with_its_line(small: Path):
    small.write_text(f'{SMALL}period = "55000 d"\n')
    with pytest.raises(BadCase, match=r"small.toml, line 6: controller.period: a time of 55000 d is too long"):
        Scene(load(small))


def test_a_name_that_hides_sda_leaves_a_bus_without_a_wire(tmp_path: Path):
    """Pin 32 is SDA. Its wire is named L2 here, so the bus of the scene has only SCL."""
    (tmp_path / "still.py").write_text("def main(dsp, settings):\n    pass\n")
    case = tmp_path / "small.toml"
    unit = 'firmware = "still.py"\nmodules = ["I2C-A"]\npins = { L2 = 32 }\n'
    case.write_text(f'name = "small"\nduration = "1 ms"\n\n[unit.dsp]\n{unit}')
    assert Scene(load(case)).run().wire_bytes == 0

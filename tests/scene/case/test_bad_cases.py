"""Mistakes in a case file: each is refused with one sentence."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim import BadCase, load
from tests.scene.small import sentence_of

UNIT = "name = 'x'\nduration = '1 s'\n[unit.dsp]\nmodules = []"
GOOD = """\
name = "small"
duration = "1 s"

[unit.dsp]
firmware = "imu_hil"
modules = ["I2C-A"]

[unit.dsp.settings]
model_cost = "250 us"

[controller]
order = ["gyroscope"]

[host]
baud = 115200

[[budget]]
name = "answer"
measure = "response"
max = "60 us"

[[budget]]
name = "nacks"
measure = "nacked"
max = 0
"""


@pytest.fixture
def case_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = Path("small.toml")
    path.write_text(GOOD, encoding="utf-8")
    return path


def refusal(path: Path, *changes: str) -> str:
    return sentence_of(BadCase, lambda: load(path, list(changes)))


def edited(path: Path, line: str, by: str) -> Path:
    assert line in GOOD
    path.write_text(GOOD.replace(line, by), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("line", "by", "sentence"),
    [
        (
            'duration = "1 s"',
            'duration = "1 s"\nbreaks = ["answer", "nack"]',
            "small.toml, line 3: breaks.1: there is no budget 'nack'; did you mean nacks?",
        ),
        (
            'duration = "1 s"',
            'duration = "1 s"\nbreaks = "nacks"',
            "small.toml, line 3: breaks: expected a list, as in ['nacks'], but it is 'nacks'",
        ),
        (
            'duration = "1 s"',
            'durations = "1 s"',
            "small.toml, line 2: there is no key 'durations'; did you mean duration?",
        ),
        (
            'order = ["gyroscope"]',
            'oder = ["gyroscope"]',
            "small.toml, line 12: there is no key 'controller.oder'; did you mean order?",
        ),
        (
            "[host]\nbaud = 115200",
            "[hots]\nbaud = 115200",
            "small.toml, line 14: there is no key 'hots'; did you mean host?",
        ),
        (
            "baud = 115200",
            "baud = 0",
            "small.toml, line 15: host.baud: expected 1 to 10000000, but it is 0",
        ),
        (
            "baud = 115200",
            'baud = "fast"',
            "small.toml, line 15: host.baud: expected a whole number, but it is 'fast'",
        ),
        (
            'duration = "1 s"',
            "duration = 1",
            'small.toml, line 2: duration: 1 has no unit; write for instance "1 ms"',
        ),
        (
            'duration = "1 s"',
            'duration = "1"',
            "small.toml, line 2: duration: '1' has no unit; write for instance 1 ms (ns, us, ms, s, min, h, d)",
        ),
        (
            'duration = "1 s"',
            'duration = "1 sec"',
            "small.toml, line 2: duration: '1 sec': unit 'sec' is none of ns, us, ms, s, min, h, d; did you mean 1 s?",
        ),
        (
            'duration = "1 s"',
            'duration = "-1 s"',
            "small.toml, line 2: duration: '-1 s' is negative; a duration is 0 or more",
        ),
        (
            'duration = "1 s"',
            'duration = "one s"',
            "small.toml, line 2: duration: 'one s': 'one' is not a number; write for instance 20",
        ),
        (
            'firmware = "imu_hil"\n',
            "",
            "small.toml, line 4: unit.dsp: a unit needs a program; give firmware, or image",
        ),
        (
            'modules = ["I2C-A"]',
            'modules = "I2C-A"',
            "small.toml, line 6: unit.dsp.modules: expected a list, as in ['I2C-A'], but it is 'I2C-A'",
        ),
        (
            'modules = ["I2C-A"]',
            "modules = []\npll = 11",
            "small.toml, line 7: unit.dsp.pll: expected 1 to 10, but it is 11",
        ),
        (
            'modules = ["I2C-A"]',
            "modules = []\noscclk = 30000000",
            'small.toml, line 7: unit.dsp.oscclk: 30000000 has no unit; write for instance "30000000 Hz"',
        ),
        (
            'modules = ["I2C-A"]',
            'modules = []\noscclk = "30 mhz"',
            "small.toml, line 7: unit.dsp.oscclk: '30 mhz': unit 'mhz' is none of Hz, kHz, MHz, GHz; "
            "did you mean 30 MHz?",
        ),
        (
            'modules = ["I2C-A"]',
            "modules = []\nppm = true",
            "small.toml, line 7: unit.dsp.ppm: True is not a number",
        ),
        (
            'order = ["gyroscope"]',
            'order = []\nperiod = "10 ms"\njitter = "11 ms"',
            "small.toml, line 11: controller: jitter is longer than period, so starts could be out of order; "
            "shorten it",
        ),
        (
            'order = ["gyroscope"]',
            'order = []\nrate = "2 MHz"',
            "small.toml, line 11: controller: hold is 300 ns, longer than SCL is low, 250 ns, so SDA would move "
            "while SCL is high; shorten hold",
        ),
        (
            'order = ["gyroscope"]',
            'pointer_by = "start"',
            "small.toml, line 12: controller.pointer_by: expected 'repeated START' or 'STOP', but it is 'start'",
        ),
        (
            'order = ["gyroscope"]',
            "[[controller.request]]\naddress = 0x68\n[[controller.request]]\naddress = 0x80",
            "small.toml, line 15: controller.request.1.address: expected an address of 7 bits, 0x00 to 0x7f, "
            "but it is 0x80; without its R/W bit, 0x80 is 0x40",
        ),
        (
            'order = ["gyroscope"]',
            "[[controller.request]]\ncount = 3",
            "small.toml, line 12: controller.request.0: a request needs either chip or address",
        ),
        (
            'order = ["gyroscope"]',
            '[[controller.request]]\naddress = 1\nwrite = "xyz"',
            "small.toml, line 14: controller.request.0.write: 'xyz' is not a sequence of bytes; "
            'write for instance "1d 00 ff"',
        ),
        (
            'order = ["gyroscope"]',
            '[[controller.request]]\nchip = "gyroscope"\ncount = 6',
            "small.toml, line 12: controller.request.0: chip says count already; "
            "leave that out or give address instead of chip",
        ),
        (
            'order = ["gyroscope"]',
            '[[controller.request]]\naddress = 1\nexpect = "00"',
            "small.toml, line 12: controller.request.0: expect has 1 byte, but count is 6",
        ),
        (
            'name = "answer"\nmeasure = "response"\nmax = "60 us"',
            'name = "answer"\nmeasure = "response"',
            "small.toml, line 17: budget.answer: a budget needs a limit: max, min, exactly, p50, p95, p99 or p99_9",
        ),
        (
            "max = 0",
            "max = 0.5",
            'small.toml, line 25: budget.nacks.max: expected a duration with its unit ("250 us"), '
            "or a whole number for counts, but it is 0.5",
        ),
        (
            "max = 0",
            "maximum = 0",
            "small.toml, line 25: there is no key 'budget.nacks.maximum'; did you mean max?",
        ),
        (
            "[unit.dsp.settings]",
            "[unit.dsp.option.i2c]",
            "small.toml, line 8: there is no key 'unit.dsp.option'; did you mean options or pins?",
        ),
    ],
)
def test_a_mistake_is_reported_with_file_line_and_correction(case_file: Path, line: str, by: str, sentence: str):
    assert refusal(edited(case_file, line, by)) == sentence


def test_missing_file(case_file: Path):
    message = refusal(Path("smal.toml"))
    assert message == "smal.toml: cannot be read (No such file or directory); did you mean small.toml?"


def test_a_missing_folder(case_file: Path):
    Path("bench").mkdir()
    case_file.rename("bench/small.toml")
    message = refusal(Path("Bench/small.toml"))
    assert message == "Bench/small.toml: cannot be read (No such file or directory); did you mean bench/small.toml?"


def test_a_mistyped_header_of_one_of_two_tables_of_a_unit(case_file: Path):
    """Line 8 is [unit.dsp.settings]."""
    message = refusal(edited(case_file, "[unit.dsp]", "[unit.dspp]"))
    assert message == "small.toml, line 8: unit.dsp.modules is missing; it is in [unit.dspp]"


def test_a_folder_is_not_a_case(case_file: Path):
    assert refusal(Path(".")) == ".: is a folder; give a case file, or run all its cases: periph-sim check ."


@pytest.mark.parametrize(
    ("text", "line", "fix"),
    [
        ("duration = 1 s", 1, 'duration = "1 s"'),
        ('duration = "1 s', 1, 'duration = "1 s"'),
        ("seed : 5", 1, "write seed = 5"),
        ("strict = True", 1, "write strict = true"),
        ("seed = n", 1, 'write a number, as 12 or 0x0c, or a text in quotes: seed = "n"'),
        ("seed = 5x", 1, "write a number, as 12 or 0x0c"),
        ('breaks = ["a", "b"\nseed = 1', 1, "close the list or table"),
        ("[host", 1, "write a header as [table]"),
        ("breaks = [\"a\"\n\n[unit.dsp]\nfirmware = 'x'", 1, "close the list or table"),
        ("pins = { A = 3\nseed = 1\n[host]", 1, "close the list or table"),
        ('text = "V?\\N"', 1, r"write \\ for a backslash, as in C:\\data"),
        ("[unit,dsp]", 1, "write [unit.dsp]"),
        ("[[controller request]] # one", 1, "write [[controller.request]]"),
        ("seed = 00", 1, "write seed = 0"),
        ("seed = -007 # one", 1, "write seed = -7"),
        ("duration: 20 ms", 1, 'duration = "20 ms"'),
        ('duration "20 ms"', 1, 'write duration = "20 ms"'),
        ("strict True", 1, "write strict = true"),
        ("pins { MODEL = 34 }", 1, "write pins = { MODEL = 34 }"),
        ("pins: { MODEL = 34 }", 1, "write pins = { MODEL = 34 }"),
        ("breaks [a, b]", 1, "write texts in quotes, a comma between entries"),
        ("seed", 1, "write seed = ..."),
        ("; a comment", 1, "write KEY = VALUE, with texts in quotes"),
        ("seed = 1\nname = 'x'\nseed = 2 # one", 3, "seed is given already in line 1; remove one of them"),
        ("[budget]\nmax = 1\n\n[[budget]]\nmax = 1", 1, "as line 4 says; write [[budget]]"),
        ("[[budget]]\nmax = 1\n[budget]\nmax = 1", 3, "as line 1 says; write [[budget]]"),
        ("name = 'x'\nduration = '1 s'\n[[controller]]\nperiod = '1 ms'", 3, "single brackets, as in [controller]"),
        ("name = 'x'\nduration = '1 s'\n[budget]\nmax = 1", 3, "double brackets, as in [[budget]]"),
        (f"{UNIT}\n[[unit.dsp.pins]]\nMODEL = 34", 5, "single brackets, as in [unit.dsp.pins]"),
        (f"{UNIT}\npins = [34]", 5, "unit.dsp.pins: expected a table, but it is [34]"),
        (f"{UNIT}\n".replace("[]", "{ GPIO = 1 }"), 4, "unit.dsp.modules: expected a list, but it is"),
        (f"{UNIT}\noscclk = 30", 5, 'write for instance "30 MHz"'),
        (f"{UNIT}\noscclk = '30'", 5, "write for instance 30 MHz"),
        (f"{UNIT}\noscclk = '30 kHz'", 5, "expected 4 MHz to 150 MHz, but it is '30 kHz'"),
        ("name = 'x'\nduration = '1 s'\n[[controller.request]]\naddress = 0x90", 4, "0x90 is 0x48"),
    ],
)
def test_a_typing_mistake_is_named_with_its_line_and_the_fix(case_file: Path, text: str, line: int, fix: str):
    case_file.write_text(text + "\n", encoding="utf-8")
    message = refusal(case_file)
    assert message.startswith(f"small.toml, line {line}: ") and fix in message


@pytest.mark.parametrize(("name", "command"), [("led.out", "image fw/led.out"), ("led.c", "c fw")])
def test_a_program_in_place_of_a_case_is_refused_with_the_command_that_writes_its_case(
    case_file: Path, name: str, command: str
):
    Path("fw").mkdir()
    Path("fw", name).write_bytes(b"\xc2\x00")
    assert refusal(Path("fw", name)) == (f"fw/{name}: is a program; write its case first: periph-sim new {command}")


def test_not_utf8(case_file: Path):
    case_file.write_bytes(b'name = "x"\nabout = "gr\xf6n"\n')
    assert refusal(case_file) == (
        "small.toml, line 2: byte 0xf6 is not UTF-8; a case file is TOML, which is UTF-8 text"
    )


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ("duration", "--set 'duration': expected key=value, for instance controller.period=10 ms"),
        ("=3", "--set '=3': expected key=value, for instance controller.period=10 ms"),
        ("a..b=3", "--set 'a..b=3': expected key=value, for instance controller.period=10 ms"),
        ("duration.x=3", "--set 'duration.x=3': duration is a value, not a table"),
        ("budget.answr.max=1 us", "--set 'budget.answr.max=1 us': there is no entry 'answr'; did you mean answer?"),
        ("budget.2.max=1 us", "--set 'budget.2.max=1 us': there is no entry '2'; it has answer, nacks"),
        (
            "controller.perod=10 ms",
            "small.toml, --set 'controller.perod=10 ms': there is no key 'controller.perod'; did you mean period?",
        ),
        (
            "controller.period=10",
            "small.toml, --set 'controller.period=10': controller.period: 10 has no unit; write for instance \"10 ms\"",
        ),
        (
            "budget.nacks.max=true",
            "small.toml, --set 'budget.nacks.max=true': budget.nacks.max: expected a duration with its unit "
            '("250 us"), or a whole number for counts, but it is true',
        ),
        (
            "controller.jitter=1 s",
            "small.toml, line 11 with --set 'controller.jitter=1 s': controller: jitter is longer than period, "
            "so starts could be out of order; shorten it",
        ),
    ],
)
def test_a_wrong_change_is_quoted_as_typed(case_file: Path, change: str, sentence: str):
    assert refusal(case_file, change) == sentence


@pytest.mark.parametrize(
    "change",
    [
        "controller.period=0 ms",
        "controller.rate=6 MHz",
        "controller.rate=0 Hz",
        "controller.low=0 ns",
        "controller.stuck_after=0 ms",
        "controller.rounds=0",
        "host.period=0 ms",
        "host.error=-100",
        "host.error=1/0",
        "host.gap=-1",
        "host.lose=[[0, 12]]",
        "host.jitter=21 ms",
        "unit.dsp.oscclk=3 MHz",
        "unit.dsp.ppm=-1000000",
        "unit.dsp.pins.X=88",
        "unit.dsp.options.i2c.answer=1.5",
        "fidelity=bytes",
        "seed=x",
        "unit=3",
        "budget.0=3",
        "controller.request=[{chip='gyroscope', address=1}]",
    ],
)
def test_values_out_of_range_are_refused_before_anything_runs(case_file: Path, change: str):
    message = refusal(case_file, change)
    assert message.startswith("small.toml, ") and repr(change) in message


def test_the_later_of_two_changes_counts(case_file: Path):
    assert load(case_file, ["seed=1", "seed=2"]).seed == 2

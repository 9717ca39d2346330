"""Firmware and devices that exit or print: an exit is never a verdict, and prints do not reach standard output."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.processor.user_case import write_case

from .conftest import Run

FIRMWARE = """\
import sys
from dataclasses import dataclass

@dataclass
class Settings:
    number: int = 1

    def __post_init__(self):
        pass  # settings

pass  # import

def tick():
    pass  # interrupt

def main(dsp, settings):
    dsp.compute(100)
    pass  # main
    dsp.handle("TINT0", tick)
    timer, pie = dsp.module("TIMER0"), dsp.module("PIE")
    timer.PRD.all = 100_000
    timer.TCR.TRB = 1
    timer.TCR.TIE = 1
    pie.PIECTRL.ENPIE = 1
    pie.PIEIER1.INTx7 = 1
    dsp.enable_interrupt(1)
    dsp.eint()
    pass  # end of main
"""
DEVICE = """\
import sys
pass  # import

class Device:
    def __init__(self, bus):
        pass  # making

    def on_write(self, byte):
        pass  # on_write

    def on_read(self):
        pass  # on_read
        return 1
"""
FIRMWARE_PLACES = ("import", "settings", "main", "interrupt")
DEVICE_PLACES = ("import", "making", "on_write", "on_read")
SAYS = "user code cannot end the command; return, or raise an error, instead of exiting"


def case_of(folder: Path, name: str = "small", firmware: str = "", device: str = "", code: str = "sys.exit(0)") -> Path:
    """Write a case whose firmware or device executes `code` at this place."""
    texts = []
    for text, place in ((FIRMWARE, firmware), (DEVICE, device)):
        if place:
            assert f"pass  # {place}\n" in text
            text = text.replace(f"pass  # {place}\n", f"{code}\n")
        texts.append(text)
    return write_case(folder, name, *texts, keys='duration = "2 ms"')


def line_of(text: str, place: str) -> int:
    return next(number for number, line in enumerate(text.splitlines(), 1) if line.endswith(f"# {place}"))


def test_the_case_passes_unchanged(periph_sim: Run, tmp_path: Path):
    periph_sim.passes("run", str(case_of(tmp_path)))


@pytest.mark.parametrize(
    ("where", "text", "file"),
    [
        *(({"firmware": place}, FIRMWARE, "small.py") for place in FIRMWARE_PLACES),
        *(({"device": place}, DEVICE, "mine.py") for place in DEVICE_PLACES),
    ],
)
def test_an_exit_is_an_error_with_its_line(
    periph_sim: Run, tmp_path: Path, where: dict[str, str], text: str, file: str
):
    (place,) = where.values()
    message = periph_sim.refused("run", str(case_of(tmp_path, **where)))
    assert f"line {line_of(text, place)} of {file}" in message and SAYS in message


def test_an_exit_while_the_scene_is_deleted_changes_no_verdict(periph_sim: Run, tmp_path: Path):
    waits = "try: dsp.spin(lambda: False)\n    finally: sys.exit(1)"
    assert "small: PASS" in periph_sim.passes("run", str(case_of(tmp_path, firmware="end of main", code=waits)))


@pytest.mark.parametrize(
    "arguments",
    [["worst"], ["trade"], ["check", "--jobs", "1"], ["sweep", "--jobs", "1", "--vary", "seed=1, 2"]],
    ids=lambda arguments: arguments[0],
)
@pytest.mark.parametrize("where", [{"firmware": "main"}, {"device": "on_read"}], ids=["firmware", "device"])
def test_no_command_takes_an_exit_for_a_verdict(
    periph_sim: Run, tmp_path: Path, arguments: list[str], where: dict[str, str]
):
    command, *options = arguments
    result = periph_sim(command, str(case_of(tmp_path, **where)), *options)
    assert result.status == 2 and SAYS in " ".join((result.out + result.err).split())


def test_check_runs_the_cases_after_one_whose_firmware_exits(periph_sim: Run, tmp_path: Path):
    first, second = case_of(tmp_path, "first", firmware="main"), case_of(tmp_path, "second")
    junit = tmp_path / "results.xml"
    result = periph_sim("check", str(first), str(second), "--jobs", "1", "--junit", str(junit))
    assert result.status == 2
    text = junit.read_text("utf-8")
    assert 'name="first"' in text and 'name="second"' in text and SAYS in text


def test_a_sweep_keeps_the_other_rows_if_firmware_exits(periph_sim: Run, tmp_path: Path):
    code = "sys.exit(0) if settings.number == 2 else None"
    case = case_of(tmp_path, firmware="main", code=code)
    result = periph_sim("sweep", str(case), "--jobs", "1", "--vary", "unit.dsp.settings.number=1, 2, 3", "--json")
    runs = result.json_object["runs"]
    assert result.status == 2 and [one["verdict"] for one in runs] == ["pass", "error", "pass"]
    assert runs[1]["error"].endswith(SAYS)


@pytest.mark.parametrize("place", ["main", "an import"])
def test_the_text_of_an_exception_is_one_printable_line(periph_sim: Run, tmp_path: Path, place: str):
    code = r"raise ValueError('line 1\nfake: PASS, as seen in this run\x1b[2J')"
    case = case_of(tmp_path, firmware="main", code=code)
    if place == "an import":
        for file in tmp_path.glob("*.py"):
            file.write_text(f"{code}\n")
    assert r"line 1\nfake: PASS, as seen in this run\x1b[2J" in periph_sim.refused("run", str(case))


@pytest.mark.parametrize("error", ["KeyboardInterrupt", "SystemExit", "GeneratorExit", "BaseException"])
def test_no_exception_of_firmware_is_a_pass(periph_sim: Run, tmp_path: Path, error: str):
    result = periph_sim("run", str(case_of(tmp_path, firmware="main", code=f"raise {error}")))
    assert (result.status, result.out) == (2, "")


@pytest.mark.parametrize("options", [[], ["--json"], ["--explain"]], ids=["table", "json", "explain"])
@pytest.mark.parametrize("place", FIRMWARE_PLACES)
def test_prints_appear_once_and_not_on_standard_output(periph_sim: Run, tmp_path: Path, options: list[str], place: str):
    """An explanation runs the case a second time; the interrupt occurs once in a run."""
    result = periph_sim("run", str(case_of(tmp_path, firmware=place, code="print('hello')")), *options)
    assert result.status == 0 and "hello" not in result.out
    assert len(set(result.err.splitlines())) == 1
    if place != "interrupt":
        assert result.err == "hello\n"
    if options == ["--json"]:
        assert result.json_object["verdict"] == "pass"


def test_firmware_may_use_standard_output_in_a_with_statement(periph_sim: Run, tmp_path: Path):
    code = "with sys.stdout as out: out.write('hel')\n    print('lo')"
    result = periph_sim("run", str(case_of(tmp_path, firmware="main", code=code)))
    assert (result.status, result.err) == (0, "hello\n") and "hello" not in result.out


def test_prints_of_a_check_appear_once(periph_sim: Run, tmp_path: Path):
    case = case_of(tmp_path, firmware="main", code="print('hello')")
    result = periph_sim("check", str(case), "--jobs", "1", "--json", "--html", str(tmp_path / "page.html"))
    assert result.err == "hello\n" and result.json_object["cases"]


def test_prints_while_the_scene_is_deleted_appear_once(periph_sim: Run, tmp_path: Path):
    waits = "try: dsp.spin(lambda: False)\n    finally: print('hello')"
    result = periph_sim("run", str(case_of(tmp_path, firmware="end of main", code=waits)), "--json")
    assert result.err == "hello\n" and result.json_object["verdict"] == "pass"

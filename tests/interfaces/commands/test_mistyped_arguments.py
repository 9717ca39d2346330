"""The error for a mistyped option, key or file name suggests the correct one."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.interfaces.commands.conftest import Run


@pytest.mark.parametrize(
    ("arguments", "fix"),
    [
        (["run", "small.toml", "--JSON"], "No such option '--JSON'. Did you mean '--json'?"),
        (["run", "small.toml", "--recrod"], "No such option '--recrod'. Did you mean '--record' or '--seconds'?"),
        (["run", "small.toml", "--qqqq"], "No such option '--qqqq'."),
        (
            ["run", "small.toml", "--set", "controller,period=5 ms"],
            "--set 'controller,period=5 ms': the parts of a key are separated by points; write controller.period=5 ms",
        ),
        (
            ["run", "small.toml", "--set", "unit/dsp/ppm=30"],
            "--set 'unit/dsp/ppm=30': the parts of a key are separated by points; write unit.dsp.ppm=30",
        ),
        (["run", "small.toml", "-second", "1"], "No such option '-second'. Did you mean '--seconds'?"),
        (["run", "small.toml", "--set", "seed", "1"], "--set seed: expected KEY=VALUE; write --set seed=1"),
        (["run", "small.toml", "--set", "seed=", "1"], "--set seed: expected KEY=VALUE; write --set seed=1"),
        (
            ["run", "small.toml", "--set", "duration", "3", "ms"],
            "--set duration: expected KEY=VALUE; write --set 'duration=3 ms'",
        ),
        (
            ["run", "small.toml", "--set", "duration", "=", "3", "ms"],
            "--set duration: expected KEY=VALUE; write --set 'duration=3 ms'",
        ),
        (["lint", "runpsr"], "runpsr: there is no such file; did you mean run.psr?"),
        (["image", "blnk.out"], "blnk.out: No such file or directory; did you mean blink.out?"),
        (["new", "image", "blink.ou"], "blink.ou: No such file or directory; did you mean blink.out?"),
        (["assemble", "ehco.asm", "x.out"], "ehco.asm: No such file or directory; did you mean echo.asm?"),
        (
            ["identify", "rst.csv"],
            "rst.csv, the file: found no such file or directory, expected a file that can be read; "
            "did you mean rest.csv?",
        ),
        (["watch", "Small.toml"], "Small.toml: cannot be read (No such file or directory); did you mean small.toml?"),
        (
            ["watch", "small.toml", "--set", "sed=2"],
            "small.toml, --set 'sed=2': there is no key 'sed'; did you mean seed?",
        ),
    ],
)
def test_the_error_for_a_mistyped_argument_suggests_the_correct_one(
    periph_sim: Run, desk: Path, arguments: list[str], fix: str
):
    for name in ("run.psr", "blink.out", "echo.asm", "rest.csv"):
        (desk / name).touch()
    assert periph_sim.refused(*arguments) == fix

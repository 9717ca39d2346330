"""Models read answers through `assume`, which records them. Exceptions are listed here with their reasons."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from periph_sim.core.options import BoolOption, IntOption, TextOption

PACKAGE = Path(__file__).parents[2] / "periph_sim"

# Exceptions in models, which store a value or use it in advance. Its effect is recorded where the comments say, which
# test_scenes.py checks.
UNRECORDED = {
    "devices/chips/adxl345.py": {"overrun_in_fifo"},  # the read of INT_SOURCE records it
    "devices/chips/hmc5883l.py": {"idle_code", "power_on_measures", "rdy_clears"},  # reads of registers do
    "devices/chips/itg3200.py": {"fs_sel_other", "who_am_i_bit_0"},  # likewise
    "f28335/cpu/interrupts.py": {"int_latency", "irq_after_iret", "vector_fetch_waits"},  # entries, requests do
    "f28335/pie/module.py": {"pieack_reset"},  # a request, or a read of PIEACK
    "f28335/i2c/lines.py": {"unequal_arrival"},  # edges that arrive together
    "f28335/i2c/module.py": {"cnt_copy_point"},  # START
    "f28335/i2c/registers.py": {"bcm_reset", "emdr_present", "noise_filter_cycles"},  # address, I2CEMDR; IRS = 1
    "f28335/i2c/slave.py": {"aas_sdir_point", "dxr_to_xsr_copy_point", "rrdy_point"},  # edges that can be skipped
    "f28335/sci/character_format.py": {
        "addrbit_hunt_with_parity", "break_bits", "break_count_from", "rxrdy_point", "start_hunt_point",
        "stop_vote_samples",
    },  # each frame
    "f28335/sci/lines.py": {"rx_sync_stages", "tx_phase"},  # each frame; each start of an idle transmitter
    "f28335/spi/lines.py": {"input_latency"},  # each edge of SPICLK
    "f28335/cpu_timer/module.py": {"timer_tif_point"},  # TIF
    "f28335/memory/memory_map.py": {"pf2_read_ws", "pf2_write_ws"},  # each access
    "processor/bus.py": {"write_lands"},  # the write that is foreseen
    "processor/image/cpu.py": {"fpu_delay_slot"},  # a slot whose result is read
    "processor/image/instruction_timing.py": {"flash_model", "stalls"},  # a fetch; a wait, or at once
    "processor/pin_router.py": {"gpio_out_delay"},  # outputs and routes that change
    "processor/python/waits.py": {"pf2_read_ws"},  # each pass
}  # fmt: skip
NOT_MODELS = ("interfaces/commands", "core/options.py", "scene")  # they calculate or display


def reads_of(path: Path) -> set[str]:
    """Return the options whose answers a module reads unrecorded, named by the object of the method call."""
    calls = (node.func for node in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(node, ast.Call))
    reads = (call.value for call in calls if isinstance(call, ast.Attribute) and call.attr == "unrecorded")
    return {ast.unparse(read).rpartition(".")[2].removeprefix("_") for read in reads}


def test_only_these_models_read_answers_unrecorded():
    found = {path.relative_to(PACKAGE).as_posix(): reads_of(path) for path in sorted(PACKAGE.rglob("*.py"))}
    models = {name: reads for name, reads in found.items() if reads and not name.startswith(NOT_MODELS)}
    assert models == UNRECORDED


@pytest.mark.parametrize("option", [TextOption("a", "x"), IntOption("a", 3), BoolOption("a", False)])
def test_an_answer_is_listed_as_it_is_read(option: TextOption | IntOption | BoolOption):
    touched = {"b"}
    assert option.unrecorded() in ("x", 3, False) and touched == {"b"}
    assert option.assume(touched) == option.unrecorded() and touched == {"a", "b"}


RAW = """
from periph_sim.f28335.i2c.options import I2cOptions
def model(options: I2cOptions) -> int:
    if options.int_line == "level":
        return options.event_to_isrc_delay
    if options.nack_clears_dxr:
        return 2
    return 1
"""


def test_a_raw_read_does_not_type_check(tmp_path: Path):
    pytest.importorskip("mypy")
    raw = tmp_path / "raw.py"
    raw.write_text(RAW, "utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--config-file", "pyproject.toml", str(raw)],
        cwd=PACKAGE.parent, capture_output=True, text=True, check=False,
    )  # fmt: skip
    errors = [line.rpartition(" ")[2] for line in done.stdout.splitlines() if "error:" in line]
    assert errors == ["[comparison-overlap]", "[return-value]", "[truthy-bool]"], done.stdout

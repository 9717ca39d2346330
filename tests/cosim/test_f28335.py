"""A case in Icarus Verilog: what foreign masters ask and get, and that the run without a simulator is the same."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cosim.benches import case, replayed, run


@pytest.mark.uncounted
def test_a_foreign_master_reads_what_the_firmware_serves(tmp_path: Path) -> None:
    found = run(tmp_path, "i2c_master", rounds=5, speed=200e3)
    assert found == {"got": [[1, 2, 3, 4]] * 5, "wire_bytes": 5 * 7, "nacked": 0}
    assert replayed(tmp_path, case())

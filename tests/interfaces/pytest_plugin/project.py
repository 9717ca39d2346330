"""A user's project with case files and tests, which the tests of the plugin run."""

from __future__ import annotations

# Modules imported before pytester runs pytest in its own process: it unloads modules that were imported in that run,
# and numpy cannot be imported twice.

# Without slipcover, which would write the counts of `make coverage` and stop when the inner session ends.
BARE_INI = """
[pytest]
addopts = -p no:slipcover
"""
INI = f"{BARE_INI}periph_sim_cases = timing\n"

SMALL = """\
name = "small"
duration = "12 ms"

[unit.dsp]
firmware = "responder"
modules = ["I2C-A"]

[controller]
rate = "100 kHz"
first = "1 ms"
period = "5 ms"

[[controller.request]]
name = "two bytes"
address = 0x50
pointer = 0x00
count = 2
expect = "01 02"

[[budget]]
name = "response"
measure = "response"
max = "60 us"
why = "the master gives up later"

[[budget]]
name = "round complete"
measure = "round"
max = "1 ms"

[[budget]]
name = "wrong bytes"
measure = "wrong bytes"
max = 0
"""

"""A user's project in a folder of its own: case files and tests that the plugin's tests run."""

from __future__ import annotations

# What pytester's own process must have imported before it runs pytest within itself: it forgets what comes new,
# and numpy cannot be imported twice.

# Without slipcover, which would write down what `make coverage` has counted, and end, as a session within ours ends.
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

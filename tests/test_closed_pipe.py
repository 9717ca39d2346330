"""No library that tests import lets a closed pipe end the process: workers of a pool die, and servers go away."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest


def test_to_write_into_a_closed_pipe_is_an_error_that_can_be_caught() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    try:
        with pytest.raises(BrokenPipeError):
            os.write(writer, b"x")
    finally:
        os.close(writer)


def test_the_reader_of_vcd_files_leaves_the_signals_of_the_process_alone() -> None:
    script = "import os; import tests.records.vcdvcd_reader; r, w = os.pipe(); os.close(r); os.write(w, b'x')"
    came = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (came.returncode, came.stderr.splitlines()[-1]) == (1, "BrokenPipeError: [Errno 32] Broken pipe")

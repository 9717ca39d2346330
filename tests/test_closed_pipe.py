"""No imported library makes a closed pipe end the process, which would end workers of a pool and servers."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest


def test_writing_to_a_closed_pipe_raises_an_exception() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    try:
        with pytest.raises(BrokenPipeError):
            os.write(writer, b"x")
    finally:
        os.close(writer)


def test_the_reader_of_vcd_files_does_not_change_signal_handlers() -> None:
    script = "import os; import tests.records.vcdvcd_reader; r, w = os.pipe(); os.close(r); os.write(w, b'x')"
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (result.returncode, result.stderr.splitlines()[-1]) == (1, "BrokenPipeError: [Errno 32] Broken pipe")

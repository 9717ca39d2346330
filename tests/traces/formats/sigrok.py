"""What sigrok's decoders say of a file: an independent reader of what we write."""

from __future__ import annotations

import subprocess
from pathlib import Path


def sigrok_says(path: Path, decoder: str) -> str:
    """The annotations of a decoder with their sample numbers, a line each."""
    command = ["sigrok-cli", "-i", str(path), "-P", decoder, "--protocol-decoder-samplenum"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout

"""Output of sigrok's decoders, used as an independent reader of written files."""

from __future__ import annotations

import subprocess
from pathlib import Path


def sigrok_says(path: Path, decoder: str) -> str:
    """Return the annotations of a decoder with their sample numbers, one per line."""
    command = ["sigrok-cli", "-i", str(path), "-P", decoder, "--protocol-decoder-samplenum"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout

"""Limits on what a reader holds in memory and a writer produces, so that no small file can fill the memory.

A zip of a few kilobytes can hold terabytes, and a count in a header can be anything.
"""

from __future__ import annotations

MOST_BYTES = 1 << 36  # bytes of unpacked samples that are read: 64 GiB, which takes some minutes
MOST_EDGES = 1 << 26  # edges of all channels together: 512 MiB of positions
MOST_METADATA = 1 << 20  # bytes of a text that describes the samples
MOST_DIRECTORY = 1 << 24  # bytes of a zip's directory: about 200 000 members
MOST_CHANNELS = 1 << 10
MOST_SAMPLES_WRITTEN = 1 << 32  # 43 s at 100 MHz; writing them takes less than a minute

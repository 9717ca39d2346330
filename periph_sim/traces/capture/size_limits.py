"""Limits on what a reader holds in memory and a writer produces, so that no small file can fill the memory.

A zip of a few kilobytes can hold terabytes, and a count in a header can be any number.
"""

from __future__ import annotations

MOST_BYTES = 1 << 36  # maximum size of unpacked samples: 64 GiB, which are read in some minutes
MOST_EDGES = 1 << 26  # maximum number of edges of all channels together: 512 MiB of positions
MOST_METADATA = 1 << 20  # maximum size in bytes of a text that describes the samples
MOST_DIRECTORY = 1 << 24  # maximum size in bytes of the directory of a zip: about 200 000 members
MOST_CHANNELS = 1 << 10
MOST_SAMPLES_WRITTEN = 1 << 32  # maximum number of written samples: 43 s at 100 MHz, written in less than a minute

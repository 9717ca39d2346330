"""Main program of a separate process: reads a waveform file and writes the states of its lines to standard output.

    python -m periph_sim.traces.formats.wellen_worker FILE --> head (JSON), a line; then for each signal
        number of changes, width (8 bytes each, in native byte order), positions (8 bytes each), states (letters)

A damaged file can make the library allocate any amount of memory and abort. This cannot be caught, so it must not
happen in the user's process. Only this module uses the library. The module has few imports, because a new process is
started for each file.
"""

from __future__ import annotations

import json
import os
import sys
from array import array
from collections.abc import Iterator
from typing import IO, Any

MEMORY = 4 << 30  # limit of the address space in bytes
SECONDS = 300  # limit of the processor time in seconds
WIDEST = 1024  # maximum number of bits of a vector
MOST_LINES = 1 << 18
FEW = 32
NO_LINES = {"Parameter", "Event", "Time"}


def limited() -> None:
    """Limit the memory and the processor time of this process, if the system supports limits."""
    try:
        import resource
    except ImportError:  # without POSIX there are no limits, but the process is still a separate one
        return
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def alone() -> IO[bytes]:
    """Return the standard output for this program alone. Output of the library is redirected to standard error."""
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    return out


def main(path: str) -> None:
    import pywellen

    limited()
    out = alone()
    wave = pywellen.Waveform(path, multi_threaded=False, remove_scopes_with_empty_name=True)
    named: list[tuple[str, int, int]] = []  # for each variable, its name, its width and the index of its signal
    places: dict[str, int] = {}
    variables: list[Any] = []  # for each signal, one of its variables
    for variable in wave.all_vars():
        width = variable.bitwidth
        if variable.is_real or variable.is_string or str(variable.var_type) in NO_LINES or not width or width > WIDEST:
            continue
        key = str(variable.signal_id)
        if key not in places:
            places[key] = len(variables)
            variables.append(variable)
        named.append((variable.full_name, width, places[key]))
    lines = sum(width for _, width, _ in named)
    if lines > MOST_LINES:
        raise ValueError(f"{lines} lines are more than {MOST_LINES}")
    timescale = wave.timescale
    head = {
        "format": str(wave.file_format),
        "factor": timescale.factor if timescale else None,
        "exponent": timescale.unit.to_exponent() if timescale else None,
        "variables": named,
        "signals": len(variables),
    }
    out.write(json.dumps(head).encode() + b"\n")
    for changes in collected(wave, places, variables):
        for part in (array("Q", (len(changes.at), changes.width)), changes.at, changes.letters):
            out.write(part)
    out.close()


class Changes:
    """The times of the changes of one signal, and the states after them.

    A state has one letter for each bit, the most significant bit first.
    """

    def __init__(self, width: int) -> None:
        self.width = width
        self.at = array("Q")
        self.letters = bytearray()

    def add(self, time: int, value: int | str) -> None:
        text = format(value, f"0{self.width}b") if isinstance(value, int) else value
        self.at.append(time)
        self.letters += text.rjust(self.width, "0").encode("ascii", "replace")[-self.width :]


def collected(wave: Any, places: dict[str, int], variables: list[Any]) -> Iterator[Changes]:
    """Yield the changes of each signal.

    If an FST file has more than FEW signals, all are read at once, because each reading scans the whole file.
    """
    if len(variables) <= FEW or str(wave.file_format) != "FST":
        for variable in variables:
            changes = Changes(variable.bitwidth)
            for time, value in variable.signal:
                changes.add(time, value)
            yield changes
        return
    all_of = [Changes(variable.bitwidth) for variable in variables]

    def change(time: int, signal: Any, value: Any) -> None:
        place = places.get(str(signal))
        if place is not None:
            all_of[place].add(time, value)

    wave.stream_changes(change, None)
    yield from all_of


if __name__ == "__main__":
    main(sys.argv[1])

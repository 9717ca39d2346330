"""A file that appears whole or not at all: a path goes in, a temporary path beside it comes out, renamed at the end.

with whole(path) as unfinished: ... write to `unfinished` ...
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..capture.capture import BadCapture


@contextmanager
def atomic_write(path: Path) -> Iterator[Path]:
    """A path of the same suffix, in the same folder, which takes the place of `path` when the block ends well.

    When the block raises, nothing is left and what stood at `path` before stays. BadCapture where no
    file can be made.
    """
    import tempfile  # only who writes pays for its start

    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}.", suffix=path.suffix)
    except OSError as error:
        raise _refused(path, error) from None
    os.close(handle)
    try:
        yield Path(name)
        os.chmod(name, 0o666 & ~_umask())
        try:
            os.replace(name, path)
        except OSError as error:
            raise _refused(path, error) from None
    except BaseException:
        os.unlink(name)
        raise


def _refused(path: Path, error: OSError) -> BadCapture:
    found = (error.strerror or "an error").lower()
    return BadCapture(path, "its place", found, "a place that can be written to", "give another path")


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask

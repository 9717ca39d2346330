"""Atomic writing of a file: to a temporary path, which is renamed at the end.

with atomic_write(path) as unfinished: ... write to `unfinished` ...
"""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ...core.input_files import is_input
from ...supervisor import remove_unless_complete
from ..capture.capture import BadCapture

NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)


@contextmanager
def atomic_write(path: Path) -> Iterator[Path]:
    """Yield a temporary path with the same suffix. Its file replaces `path` when the block ends without an error.

    Links are followed. A device or pipe, such as /dev/stdout, is never replaced: the bytes are copied to it when the
    block ends. If the block raises, the temporary file is removed and the file at `path` is unchanged.

    Raise BadCapture if no file can be created, if the disk is full, or if the present command has read the file at
    `path`, because an output never replaces an input.
    """
    import shutil
    import tempfile  # imported here because only writing needs it

    whole = Path(os.path.realpath(path)) if path.is_symlink() else path
    replaced = whole.is_file() or not path.exists()
    if path.is_dir():
        raise _refused(path, IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR)))
    _refuse_input(whole)
    try:
        folder = whole.parent if replaced else None
        handle, name = tempfile.mkstemp(dir=folder, prefix=f".{path.stem}.", suffix=path.suffix)
    except OSError as error:
        raise _refused(path, error) from None
    os.close(handle)
    remove_unless_complete(name)
    try:
        try:
            yield Path(name)
        except OSError as error:
            if error.errno in NO_ROOM:
                raise _refused(path, error) from None
            raise
        _refuse_input(whole)
        try:
            if replaced:
                os.chmod(name, 0o666 & ~_umask())
                os.replace(name, whole)
            else:
                with open(name, "rb") as source, open(path, "wb") as target:
                    shutil.copyfileobj(source, target)
                os.unlink(name)
        except BrokenPipeError:
            raise
        except OSError as error:
            raise _refused(path, error) from None
    except BaseException:
        os.unlink(name)
        raise


def _refuse_input(path: Path) -> None:
    if is_input(path):
        found = "a file that this command reads"
        raise BadCapture(path, "its place", found, "a file that is no input", "give the output another path")


def _refused(path: Path, error: OSError) -> BadCapture:
    found = (error.strerror or "an error").lower()
    return BadCapture(path, "its place", found, "a place that can be written to", "give another path")


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask

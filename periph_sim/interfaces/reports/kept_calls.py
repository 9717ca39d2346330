"""Results of the calls of a table, kept in a file, so that `prove --table --save` continues after it was stopped.

    calls --KeptCalls.call_all--> results --save--> proofs/NAME.unfinished --next command--> the same results

The result of a call depends on its arguments and on the dependencies of the case only. So a result in the file belongs
to each call whose arguments have the same digest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from hashlib import blake2b
from pathlib import Path
from time import monotonic
from typing import ClassVar, get_type_hints

import msgspec

from ...proof.calls import CallAll, T, Ts
from ...proof.dependencies import Dependencies
from ...proof.saved_file import BadSavedFile, SavedFile
from ...proof.saved_paths import unfinished_path
from ...proof.stretch import Job
from ...traces.formats import atomic_write
from .coverage import SAVED_EVERY

ANEW = "the table is made anew"


class UnfinishedTable(SavedFile, frozen=True, kw_only=True):
    """The contents of the file.

    results: a dictionary from the digest of each finished call to its result, in MessagePack.
    digest: the digest of `results`.
    """

    WHAT: ClassVar[str] = "unfinished table"
    RENEW: ClassVar[str] = ANEW
    results: dict[str, bytes]
    digest: str


class KeptCalls:
    """Makes calls, unless their results are in the file of a table that was stopped.

    path: the path of the file.
    note: a sentence that says whether the results in the file are used; "" without a file.
    """

    def __init__(self, case: Path) -> None:
        """case: the path of the case."""
        self.path, self.note = unfinished_path(case), ""
        self._depends: Callable[[], Dependencies | None] = lambda: None
        self._results: dict[str, bytes] = {}
        self._saved_at = monotonic()
        try:
            found = UnfinishedTable.current(self.path, case)
        except BadSavedFile as error:
            self.note = str(error)
            return
        if found is not None:
            contents, reasons = found
            if contents.digest != _digest(contents.results):
                reasons.append("its contents are damaged")
            if reasons:
                self.note = f"{self.path} is not continued, because {reasons[0]}; {ANEW}"
            else:
                self.note, self._results = f"continued from {self.path}", contents.results

    def call_all(self, call_all: CallAll, depends: Callable[[], Dependencies | None]) -> CallAll:
        """Return a function that makes calls as `call_all` does, and keeps their results.

        depends: returns the dependencies of the results so far; None if one of them has changed meanwhile.
        """
        self._depends = depends

        def call(work: Callable[[*Ts], T], calls: Sequence[tuple[*Ts]]) -> Iterable[T]:
            kind: type[T] = get_type_hints(work)["return"]
            keys = [_key(work.__name__, arguments) for arguments in calls]
            missing = {key: one for key, one in zip(keys, calls, strict=True) if key not in self._results}
            made = iter(call_all(work, list(missing.values())))
            for key in keys:
                if key not in self._results:
                    self._results[key] = msgspec.msgpack.encode(next(made))
                    if monotonic() - self._saved_at > SAVED_EVERY:
                        self.save()
                yield msgspec.msgpack.decode(self._results[key], type=kind)

        return call

    def save(self) -> bool:
        """Write the results to the file, completely or not at all, and return True.

        If there are none, or if a dependency has changed, write nothing, and return False.

        Raise BadCapture if the file cannot be written.
        """
        self._saved_at, depends = monotonic(), self._depends()
        if depends is None or not self._results:
            return False
        contents = UnfinishedTable(dependencies=depends, results=self._results, digest=_digest(self._results))
        self.path.parent.mkdir(exist_ok=True)
        with atomic_write(self.path) as file:
            file.write_bytes(msgspec.json.encode(contents))
        return True

    def remove(self) -> None:
        """Remove the file, because the table is finished."""
        self.path.unlink(missing_ok=True)


def _digest(results: Mapping[str, bytes]) -> str:
    return blake2b(msgspec.msgpack.encode(results), digest_size=16).hexdigest()


def _key(name: str, arguments: Sequence[object]) -> str:
    """Return the digest of a call. It does not depend on the folder from which the case is named."""
    whole = [msgspec.structs.replace(one, file="") if isinstance(one, Job) else one for one in arguments]
    text = msgspec.msgpack.encode([name, *whole], enc_hook=_plain)
    return blake2b(text, digest_size=16).hexdigest()


def _plain(value: object) -> object:
    return vars(value) if hasattr(value, "__dict__") else str(value)

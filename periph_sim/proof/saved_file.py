"""Files with saved results and everything they depend on: a coverage or a proof, as JSON beside its case.

results, Dependencies --text_of--> file --read, current--> results, and a phrase for each dependency that has changed
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Protocol, TypeVar

import msgspec

from ..core.input_error import InputError
from ..core.input_files import read_regular
from .dependencies import Dependencies


class HasDependencies(Protocol):
    """The contents of a saved file."""

    @property
    def dependencies(self) -> Dependencies: ...


T = TypeVar("T", bound=HasDependencies)


class BadSavedFile(InputError):
    """Error: a file of saved results cannot be read. The message is one sentence."""


def text_of(contents: msgspec.Struct) -> str:
    """Return the text of a file: JSON with sorted keys and sets, so that equal contents have equal texts."""
    tree = msgspec.to_builtins(contents, order="sorted")
    return json.dumps(tree, indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def read(path: Path, kind: type[T], what: str, renew: str) -> T | None:
    """Return the contents of a file; None if there is no file.

    kind: the class of the contents. what: their name, such as "coverage". renew: a phrase that says how to renew them.

    Raise BadSavedFile if the file cannot be read, has other contents, or is of another version of the format.
    """
    try:
        return msgspec.json.decode(read_regular(path), type=kind)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise BadSavedFile(f"{path}: cannot be read ({error.strerror}); expected a {what}") from None
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise BadSavedFile(f"{path}: is no {what} of this version of periph-sim ({error}); {renew}") from None


def current(contents: T | None, case: Path) -> tuple[T, list[str]] | None:
    """Return the contents of a saved file, with a phrase for each changed dependency; None if `contents` is None.

    The first phrase is about the case if the file belongs to another case file. case: the path of the case.
    """
    if contents is None:
        return None
    differences = contents.dependencies.differences(case.parent)
    if case.name not in contents.dependencies.files:  # the file was copied
        differences.insert(0, f"it belongs to another case file than {case.name}")
    return contents, differences

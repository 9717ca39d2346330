"""Files with saved results and everything they depend on: a coverage, a proof or an unfinished table.

SavedFile --text_of--> file --read, current--> SavedFile, and a phrase for each dependency that has changed
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import ClassVar, Literal, Self

import msgspec

from ..core.input_error import InputError
from ..core.input_files import read_regular
from .dependencies import Dependencies


class BadSavedFile(InputError):
    """Error: a file of saved results cannot be read. The message is one sentence."""


class SavedFile(msgspec.Struct, frozen=True, kw_only=True):
    """The contents of a file of saved results. Each kind of file has a subclass.

    WHAT: the word for the contents, such as "coverage".
    RENEW: how to make them again, such as "write it again with prove --table --save".
    version: the version of the format.
    dependencies: everything on which the results depend.
    """

    WHAT: ClassVar[str]
    RENEW: ClassVar[str]
    version: Literal[1] = 1
    dependencies: Dependencies

    @classmethod
    def read(cls, path: Path) -> Self | None:
        """Return the contents of a file; None if there is no file.

        Raise BadSavedFile if it cannot be read, or has contents of another kind or of another version of the format.
        """
        try:
            return msgspec.json.decode(read_regular(path), type=cls)
        except FileNotFoundError:
            return None
        except OSError as error:
            raise BadSavedFile(f"{path}: cannot be read ({error.strerror}); expected a {cls.WHAT}") from None
        except (msgspec.DecodeError, UnicodeDecodeError) as error:
            raise BadSavedFile(
                f"{path}: is no {cls.WHAT} of this version of periph-sim ({error}); {cls.RENEW}"
            ) from None

    @classmethod
    def current(cls, path: Path, case: Path) -> tuple[Self, list[str]] | None:
        """Return the contents of a file, and a phrase for each dependency that has changed; None if there is no file.

        Without a change, the list of phrases is empty. If the file is a copy of that of another case, the first phrase
        says so. case: the path of the case. Raise BadSavedFile if the file cannot be read.
        """
        contents = cls.read(path)
        if contents is None:
            return None
        differences = contents.dependencies.differences(case.parent)
        if case.name not in contents.dependencies.files:  # the file is a copy of that of another case
            differences.insert(0, f"it belongs to another case file than {case.name}")
        return contents, differences


def text_of(contents: SavedFile) -> str:
    """Return the text of a file: JSON with sorted keys and sets, so that equal contents have equal texts."""
    tree = msgspec.to_builtins(contents, order="sorted")
    return json.dumps(tree, indent=1, sort_keys=True, ensure_ascii=False) + "\n"

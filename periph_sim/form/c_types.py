"""Names for annotations of compiled modules. They denote C types; for mypy they are aliases of Python's types.

In the compiled core, ordinary annotations denote C types, too: `int` is a C integer of 64 bits, `bool` is a C truth
value, `NDArray[np.int64]` is a contiguous buffer, and `Annotated[list[int], 8]` is an array of 8 integers inside the
object.
"""

from __future__ import annotations

from array import array as Buffer  # a contiguous buffer of 64-bit integers, or of 32-bit integers in `Buffer[UInt32]`
from collections.abc import Callable as CFunction  # a pointer to a C function: `CFunction[[Cpu, Operation], None]`

BigInt = int  # a Python integer, for numbers that may have more than 64 bits, such as a user's input
Text = str  # a Python string, which may be an instance of a subclass such as `SourceLocation`
UInt8 = int  # an unsigned C integer of 8 bits
UInt16 = int  # an unsigned C integer of 16 bits
UInt32 = int  # an unsigned C integer of 32 bits

__all__ = ["BigInt", "Buffer", "CFunction", "Text", "UInt8", "UInt16", "UInt32"]

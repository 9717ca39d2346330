"""Type names for annotations of compiled modules that express what Python's own types cannot; aliases to mypy.

Without them `int` is a C integer of 64 bits in the compiled core, `bool` a C truth value, `NDArray[np.int64]` a
contiguous buffer, and `Annotated[list[int], 8]` an array of 8 integers inside the object.
"""

from __future__ import annotations

from array import array as Buffer  # a contiguous buffer of 64-bit integers, of `Buffer[UInt32]` of 32 bits each
from collections.abc import Callable as CFunction  # a pointer to a C function: `CFunction[[Cpu, Operation], None]`

BigInt = int  # an integer that may need more than 64 bits, or that a user gives: a Python object
Text = str  # a string that may be an instance of a subclass, as `SourceLocation` is: any Python object
UInt8 = int  # unsigned C integers of 8, 16 and 32 bits
UInt16 = int
UInt32 = int

__all__ = ["BigInt", "Buffer", "CFunction", "Text", "UInt8", "UInt16", "UInt32"]

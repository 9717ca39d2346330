"""Type names for annotations of compiled modules: C types that Python's own types cannot express. mypy sees aliases.

In the compiled core, the usual annotations have these meanings: `int` is a C integer of 64 bits, `bool` a C truth
value, `NDArray[np.int64]` a contiguous buffer, and `Annotated[list[int], 8]` an array of 8 integers inside the object.
"""

from __future__ import annotations

from array import array as Buffer  # a contiguous buffer of 64-bit integers; `Buffer[UInt32]` has 32-bit integers
from collections.abc import Callable as CFunction  # a pointer to a C function: `CFunction[[Cpu, Operation], None]`

BigInt = int  # a Python object: an integer that may need more than 64 bits, or that comes from a user
Text = str  # any Python object: a string that may be an instance of a subclass, such as `SourceLocation`
UInt8 = int  # unsigned C integers of 8, 16 and 32 bits
UInt16 = int
UInt32 = int

__all__ = ["BigInt", "Buffer", "CFunction", "Text", "UInt8", "UInt16", "UInt32"]

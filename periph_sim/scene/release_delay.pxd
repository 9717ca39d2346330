cimport cython

from ..core.chip cimport Chip
from ..core.kernel cimport Kernel
from ..core.socket cimport Socket
from ..core.time cimport Clock


cdef class ReleaseDelay:
    cdef Kernel _kernel
    cdef Clock _clock
    cdef Socket _socket
    cdef long long _setup, _pin
    cdef frozenset _touched
    @cython.locals(chip=Chip, clock=Clock, now=cython.longlong, prescaler=cython.longlong, emdr=cython.longlong, module=cython.longlong, copy=cython.longlong, cycles=cython.longlong)
    cpdef long long ticks(self)

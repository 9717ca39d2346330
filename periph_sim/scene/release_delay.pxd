cimport cython

from ..core.chip cimport Chip
from ..core.kernel cimport Kernel
from ..core.socket cimport Socket
from ..core.time cimport Clock


cdef class ReleaseDelay:
    cdef Kernel _kernel
    cdef Clock _clock
    cdef Socket _socket
    cdef long long _setup, _pin, _writes, _cycles
    cdef frozenset _touched
    @cython.locals(clock=Clock, cycle=cython.longlong)
    cpdef long long ticks(self, long long written)
    @cython.locals(chip=Chip, prescaler=cython.longlong, emdr=cython.longlong, module=cython.longlong, copy=cython.longlong)
    cdef object _look(self, long long now)

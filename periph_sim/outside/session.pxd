cimport cython

from ..core.kernel cimport Kernel
from .door cimport Door
from .reaction cimport Reaction


cdef class Session:
    cdef public object case, scene
    cdef public tuple lines
    cdef public long long ticks_per_second
    cdef Kernel _kernel
    cdef long long _start, _now
    cdef Door _door
    cdef public Reaction _reaction
    cdef object _log, _master, _result
    cdef dict _serial
    cdef list _fed
    cdef void _check_tick(self, object tick)
    cdef void _open(self)
    cdef object _at(self, long long tick)

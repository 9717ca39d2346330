cimport cython

from .execution.registers cimport Operation


@cython.final
cdef class Pipeline:
    cdef public long long clock, until, pending
    cdef public bint enabled
    cdef public long long packed_stores[13]
    cdef long long _at
    cdef long long _first[4]
    cdef long long _last[4]
    cdef long long _ready[4]
    cpdef void drain(self)
    @cython.locals(at=cython.longlong, place=cython.longlong, rest=cython.longlong)
    cpdef void pack(self)
    @cython.locals(needs=cython.longlong, pending=cython.longlong, waits=cython.longlong)
    cpdef long long stall(self, Operation f, long long arp)
    cpdef void issued(self, Operation f, long long cycles)
    @cython.locals(at=cython.longlong)
    cpdef void wrote(self, long long address, long long words, long long cycle)
    @cython.locals(at=cython.longlong, waits=cython.longlong, more=cython.longlong)
    cpdef long long read(self, long long address, long long words)
    cdef void _pass(self, long long cycles)

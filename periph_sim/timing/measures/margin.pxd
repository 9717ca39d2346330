cimport cython

from .bus_from_wires cimport BusFromWires
from .measure cimport Measure


cdef class _Reads(BusFromWires):
    cdef Margin _measure
    cpdef void first_bit(self, long long let_go, long long rose)


cdef class Margin(Measure):
    cdef public _Reads bus
    cdef str _unit
    cdef object _delay
    cdef long long _waiting, _shifting
    cdef bint _empty
    cpdef long long tag_of(self, object kind, str where, str what)
    cpdef void hear(self, long long tag, long long tick, long long value)
    cdef void _copied(self)
    @cython.locals(written=cython.longlong, delay=cython.longlong)
    cpdef void needed(self, long long let_go, long long rose)


cdef class _Lows(BusFromWires):
    cdef HeldPerTransfer _measure
    cpdef void started(self, long long now)
    cpdef void stopped(self, long long now)
    cpdef void held(self, long long let_go, long long rose)


cdef class HeldPerTransfer(Measure):
    cdef public _Lows bus
    cdef long long _began, _sum
    cpdef void begins(self, long long at)
    cpdef void add(self, long long ticks)
    cpdef void over(self)

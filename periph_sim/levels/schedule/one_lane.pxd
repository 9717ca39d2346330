cimport cython


@cython.final
cdef class Piece:
    cdef public long long length, first, last, calm_first, calm_second
    cdef long long[::1] lengths, first_marks, second_marks


@cython.final
cdef class Lane:
    cdef public long long service, waits, num, den, lowest, number, begun, before, first_begun, mark, second_mark
    cdef public bint by_other
    cdef long long[::1] late
    cdef long long _latch, _lowest_of_zero, _spread, _ahead, _high, _margin, _edge, _sync, _period, _behind, _late_at, _frames, _due, _whole, _rest, _part, _parts
    cdef bint _jitter, _pause
    cpdef void hosts(self, long long[::1] late, bint jitter, bint pause, long long frames)
    cpdef void host(self, long long first, long long num, long long den, long long place)
    cdef void _make(self)
    @cython.locals(cycle=cython.longlong)
    cdef long long latch(self)
    cdef bint calm(self, long long cycle)
    cpdef void take(self)
    cdef long long tick(self, long long cycle)
    cdef long long cycle_at(self, long long tick)
    cdef long long margin(self, long long let_go, long long landed)
    @cython.locals(well_before=cython.longlong)
    cpdef long long wait_from_far(self, long long first, long long flag, long long poll)
    @cython.locals(waits=cython.longlong, end=cython.longlong, passes=cython.longlong, latch=cython.longlong)
    cpdef long long wait(self, long long first, long long flag, long long poll, long long fetched)
    cpdef long long split(self, long long first, long long flag, long long poll, long long second, long long other)
    cpdef long long code(self, long long begin, Piece piece)
    cpdef long long run(self, long long begin, long long cycles)

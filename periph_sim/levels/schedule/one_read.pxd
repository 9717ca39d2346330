cimport cython

from .kept cimport Kept, Memory
from .kept_margins cimport KeptMargins
from .one_lane cimport Lane, Piece
from .value_range cimport ValueRange


@cython.final
cdef class OneRead:
    cdef Lane _lane
    cdef ValueRange _margins, _cleared
    cdef Memory _memory
    cdef public bint hung, plain
    cdef public long long poll, refused, eighth, stop, again, end, off, ready, held, response, let_go
    cdef public long long written
    cdef Kept _kept
    cdef Piece _pointer, _clear, _first, _after
    cdef list _more
    cdef long long[128] _edges
    cdef long long[32] _let_gos, _rises, _landed
    cdef long long _count, _seen, _low, _poll_two, _second, _release
    cdef long long _clock, _start, _cycle
    cpdef void of_clock(self, long long number)
    @cython.locals(memory=Memory)
    cdef long long _flag(self, long long place, long long cycle, long long rest)
    @cython.locals(lane=Lane, kept=Kept, stop=cython.longlong, addressed=cython.longlong, addressed_at=cython.longlong,
        number=cython.longlong, byte=cython.longlong)
    cpdef void serve(self, long long start, long long cycle, long long rest, long long first, long long last)
    @cython.locals(
        lane=Lane, begun=cython.longlong, pointer=cython.longlong, asked_at=cython.longlong, landed=cython.longlong,
        shift=cython.longlong, ready=cython.longlong, over_at=cython.longlong, byte=cython.longlong,
        needed=cython.longlong, from_here=cython.longlong, let_go=cython.longlong, rise=cython.longlong,
        part=cython.longlong, most=cython.longlong, least=cython.longlong, free=cython.longlong, seen=cython.longlong, poll_two=cython.longlong, count=cython.longlong)
    cdef void _work(self, long long start, long long cycle, long long rest, long long addressed, long long last)
    @cython.locals(
        lane=Lane, margins=ValueRange, byte=cython.longlong, let_go=cython.longlong, landed=cython.longlong,
        part=cython.longlong, value=cython.longlong)
    cdef void _measure(self)
    @cython.locals(byte=cython.longlong)
    cdef void _restore(self)
    @cython.locals(
        lane=Lane, rest=cython.longlong, byte=cython.longlong, let_go=cython.longlong, landed=cython.longlong,
        part=cython.longlong)
    cpdef void keep_margins(self, KeptMargins margins, long long start, long long cycle)

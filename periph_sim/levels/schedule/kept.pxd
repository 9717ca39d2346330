cimport cython

from .kept_margins cimport KeptMargins


@cython.final
cdef class Kept:
    cdef public long long of, end, off, ready, cleared_most, cleared_least, asked_most, asked_least
    cdef KeptMargins margins
    cdef long long[32] landed


@cython.final
cdef class Memory:
    cdef long long[128] whole, part, _edges, _ends, _buckets
    cdef long long _phases, _count, _shift
    cdef list _kept
    cdef Kept _nothing
    @cython.locals(
        count=cython.longlong, place=cython.longlong, ticks=cython.longlong, end=cython.longlong, interval=cython.longlong,
        bucket=cython.longlong)
    cpdef void of_clock(self, long long num, long long den)
    @cython.locals(interval=cython.longlong, found=Kept)
    cpdef Kept find(self, long long rest, long long phase)
    @cython.locals(found=Kept)
    cdef Kept _new(self, long long place)

cimport cython

from ...core.kernel cimport Agent, Event, Kernel
from ...core.wire cimport Wire


@cython.final
cdef class Deaf(Agent):
    pass


cdef class EdgePlay(Agent):
    cdef Kernel _kernel
    cdef Wire _scl, _sda
    cdef long long _scl_mask, _sda_mask, _byte, _bit, _low, _high, _hold
    cdef Event _next
    cpdef void begin(self, long long byte, long long low, long long high, long long hold)
    @cython.locals(now=cython.longlong, around=cython.longlong, rise=cython.longlong)
    cpdef void act(self, long long tag)
    cpdef void stop(self)
    cdef void _then(self, long long time, long long tag)


cdef class SdaFollows(Agent):
    cdef Kernel _kernel
    cdef Wire _sda
    cdef long long _mask, _hold, _byte, _bit
    cdef bint _rose
    cdef Event _next
    cpdef void begin(self, long long byte)
    @cython.locals(around=cython.longlong)
    cpdef void sampled(self, long long now, long long levels)
    cpdef void follow(self, long long now, long long level)
    cpdef void then(self, long long time, long long tag, long long phase)
    cpdef void stop(self)

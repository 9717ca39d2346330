cimport cython

from ...core.kernel cimport Event, Kernel
from .whole_frames cimport FrameParty


cdef class UartReader(FrameParty):
    cdef public list on_begin, on_end
    cdef Kernel _kernel
    cdef object _line, _bit, _format
    cdef long long _start, _set_at, _length
    cdef list _halves, _edges
    cdef Event _ending
    @cython.locals(ending=Event)
    cpdef void sampled(self, long long now, long long levels)
    @cython.locals(num=object, den=object, half=object)
    cdef void _set_line(self, long long now)
    cdef void _begin(self, long long now)
    @cython.locals(middle=cython.longlong, passed=cython.longlong, level=cython.longlong, bit=cython.longlong, edges=list)
    cdef void _end(self)

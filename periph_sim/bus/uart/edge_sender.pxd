cimport cython

from ...core.kernel cimport Event, Kernel
from .whole_frames cimport FrameSender, WholeFrames


cdef class EdgeSender(FrameSender):
    cdef public WholeFrames whole_frames
    cdef Kernel _kernel
    cdef long long _mask, _left, _level
    cdef list _edges, _counts
    cdef Event _next
    cpdef void drive(self, long long level)
    cpdef void last_edge(self)
    cpdef void make(self, list edges, list counts)
    @cython.locals(edges=list)
    cpdef void edge(self)
    @cython.locals(edges=list, left=cython.longlong, behind=cython.longlong, between=list)
    cdef void _begin_frame(self)
    cdef void _then(self, long long tick)

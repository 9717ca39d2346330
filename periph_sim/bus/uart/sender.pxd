cimport cython

from ...core.kernel cimport Agent, Kernel
from ...core.records cimport Recorder
from ...core.wire cimport Wire


cdef class UartSender(Agent):
    cdef public str who
    cdef Kernel _kernel
    cdef Recorder _recorder
    cdef Wire _wire
    cdef long long _mask, _length, _level, _ends_at
    cdef object _bit, _format, _gap, _done
    cdef dict _edges_of
    cdef list _begins, _edges
    @cython.locals(start=cython.longlong, first=cython.longlong, edges=list, bit=cython.longlong, byte=cython.longlong)
    cpdef object send(self, object data, object gap, object done)
    cdef void _edge(self)
    @cython.locals(parts=object, pause=object, num=object, den=object, at=object, frame=object, bit=object)
    cdef void _measure(self, long long frames, object gap)
    cdef list _edges_in(self, long long byte)

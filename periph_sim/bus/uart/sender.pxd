cimport cython

from ...core.records cimport Recorder
from ...core.wire cimport Wire
from .edge_sender cimport EdgeSender


@cython.final
cdef class UartSender(EdgeSender):
    cdef public str who
    cdef Recorder _recorder
    cdef Wire _wire
    cdef long long _length, _ends_at
    cdef object _bit, _format, _gap, _done
    cdef dict _edges_of
    cdef list _begins
    @cython.locals(start=cython.longlong, first=cython.longlong, edges=list, counts=list, bits=list, bit=cython.longlong, byte=cython.longlong)
    cpdef object send(self, object data, object gap, object done)
    @cython.locals(parts=object, pause=object, num=object, den=object, at=object, frame=object, bit=object)
    cdef void _measure(self, long long frames, object gap)
    cdef list _edges_in(self, long long byte)

cimport cython

from .uart.whole_frames cimport FrameParty


@cython.final
cdef class UartCounter(FrameParty):
    cdef public list told
    cdef object _line, _as
    cdef long long _lasted, _taken, _begun_at, _over_at, _free_at
    cpdef void finish(self, long long now)
    cdef void _set_line(self)
    cdef void _tell(self)

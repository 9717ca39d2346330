cimport cython

from ...core.kernel cimport Kernel
from ...core.wire cimport Pin
from .edge_play cimport SdaFollows
from .whole_bytes cimport ByteParty


cdef class TargetSide(ByteParty):
    cdef public str who
    cdef Kernel _kernel
    cdef public Pin _sda, _scl
    cdef object _answer, _reply, _on_end
    cdef dict _stretches
    cdef SdaFollows _mover
    cdef long long _does, _lines, _hold, _bit, _in, _out, _byte, _level, _held_until
    cdef bint _refused, _taken, _powered
    cpdef void act(self, long long tag)
    @cython.locals(event=cython.longlong)
    cpdef void sampled(self, long long now, long long levels)
    cdef void _fall(self)
    cdef void _stretch(self)
    cdef void _rise(self, long long level)
    cdef long long _ninth(self)
    cdef void _byte_over(self)
    cdef void _put(self, long long level)
    cpdef long long pulls(self, long long line)
    cpdef long long follow_at(self, long long fall)
    cpdef bint ready(self, long long low, long long high, long long hold, bint each)
    cpdef bint steps(self)
    cpdef long long byte(self)
    cpdef SdaFollows meanwhile(self)
    cpdef void stand(self, long long shown, long long bit, long long fell)

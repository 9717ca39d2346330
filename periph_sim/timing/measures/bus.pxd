cimport cython

from ...bus.i2c.transfer cimport Phase, Transfer
from .measure cimport Measure


@cython.locals(first=Phase)
cpdef long long begin_of(Transfer transfer, Phase phase)


cdef class PhaseMeasure(Measure):
    cpdef void phase(self, Transfer transfer, Phase phase)


cdef class Response(PhaseMeasure):
    cpdef void phase(self, Transfer transfer, Phase phase)


cdef class Stretch(PhaseMeasure):
    cdef object _scene
    cdef long long _held_since
    cpdef void phase(self, Transfer transfer, Phase phase)


cdef class WrongBytes(PhaseMeasure):
    cdef public dict where
    cdef public str first
    cdef object _origins
    cdef dict _zeros
    cdef long long _unknown
    cdef bint _is_judged(self, Phase phase, long long compared)
    @cython.locals(got=bytearray, wanted=bytes, compared=cython.longlong)
    cpdef void phase(self, Transfer transfer, Phase phase)
    cdef bytes _wanted(self, Phase phase)

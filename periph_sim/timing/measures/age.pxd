cimport cython

from ...bus.i2c.transfer cimport Phase, Transfer
from .bus cimport PhaseMeasure


cdef class ReadMeasure(PhaseMeasure):
    cdef public set addresses
    cdef public long long first_frame
    @cython.locals(begin=cython.longlong)
    cpdef void phase(self, Transfer transfer, Phase phase)
    cpdef void frame(self, long long tick)
    cpdef void chip_read(self, Phase phase)


cdef class Age(ReadMeasure):
    cdef object _origins
    cdef dict _shown
    cdef long long _unknown
    cpdef void chip_read(self, Phase phase)


cdef class ModelAge(ReadMeasure):
    cdef long long _sent, _taken, _made
    cpdef long long tag_of(self, object kind, str where, str what)
    cpdef void hear(self, long long tag, long long tick, long long value)
    cpdef void frame(self, long long tick)
    @cython.locals(since=cython.longlong)
    cpdef void chip_read(self, Phase phase)

cimport cython

from ...core.kernel cimport Agent


cdef class I2cByteCounter(Agent):
    cdef public long long bytes
    cdef long long _lines, _pulses
    cdef bint _active
    @cython.locals(event=cython.longlong)
    cpdef void sampled(self, long long now, long long levels)

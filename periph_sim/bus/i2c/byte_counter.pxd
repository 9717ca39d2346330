cimport cython

from .bit_times cimport BitTimes
from .whole_bytes cimport ByteParty


cdef class I2cByteCounter(ByteParty):
    cdef public long long bytes
    cdef long long _lines, _pulses
    cdef bint _active
    @cython.locals(event=cython.longlong)
    cpdef void sampled(self, long long now, long long levels)
    cpdef void edge(self, long long tick, long long levels)
    cpdef void heard(self, long long shown, BitTimes times)

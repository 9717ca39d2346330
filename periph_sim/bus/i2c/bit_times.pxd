cimport cython

from ...core.time cimport Clock


cdef class BitTimes:
    cdef public long long since, low, high
    cpdef long long rise(self, long long number)
    cpdef long long fall(self, long long number)


@cython.final
cdef class CycleTimes(BitTimes):
    cdef Clock _clock

from .measure cimport Measure


cdef class OfCharacters(Measure):
    cdef long long _received
    cpdef void changed(self, long long tick, long long words, bint overrun)


cdef class FifoHighWater(OfCharacters):
    cpdef void changed(self, long long tick, long long words, bint overrun)

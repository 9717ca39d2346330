cdef class ReceiverListener:
    cpdef void changed(self, long long tick, long long words, bint overrun)
    cpdef void received(self, long long tick)

cdef class SciTxBits:
    cdef public long long level, next_tick
    cdef list _edges
    cpdef void send(self, long long tick, long long levels, long long bits)
    cpdef void resend(self, long long tick, long long levels, long long bits, long long done)
    cpdef void step(self)
    cpdef void stop(self)

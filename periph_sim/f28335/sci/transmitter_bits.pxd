cimport cython


@cython.final
cdef class SciTxBits:
    cdef public long long level, next_tick
    cdef public bint fresh
    cdef list _edges, _taken
    cdef long long _count
    cpdef void send(self, long long tick, long long levels, long long bits)
    cpdef void resend(self, long long tick, long long levels, long long bits, long long done)
    cpdef void step(self)
    cpdef void stop(self)
    cpdef list coming(self)
    cpdef void take(self)
    cpdef void give_back(self, long long count)

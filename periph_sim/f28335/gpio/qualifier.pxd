cimport cython


@cython.final
cdef class Qualifier:
    cdef public long long level, qualified, due
    cdef long long _period, _samples, _origin, _sampled, _run, _done
    cpdef void edge(self, long long now, long long level)
    cpdef void advance(self, long long now)
    cpdef void configure(self, long long now, long long period, long long samples, long long origin)
    cdef void _plan(self)

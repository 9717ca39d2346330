from ...core.records cimport Listener
from .tally cimport Tally


cdef class Measure(Listener):
    cdef public long long count, worst, least, worst_at, least_at, cut_off, not_before
    cdef public str not_judged
    cdef public object occasions, tap
    cdef public object _kept
    cdef public Tally _tally
    cpdef long long tag_of(self, object kind, str where, str what)
    cpdef void occasion(self, long long at, long long number=*)
    cpdef void take(self, long long value, long long at)

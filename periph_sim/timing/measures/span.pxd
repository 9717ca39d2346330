from .measure cimport Measure


cdef class SpanTime(Measure):
    cdef str _name
    cdef dict _began
    cdef set _spans
    cdef list _heard
    cpdef long long tag_of(self, object kind, str where, str what)
    cpdef void hear(self, long long tag, long long tick, long long value)

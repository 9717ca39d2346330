from .measure cimport Measure


cdef class Load(Measure):
    cdef object _seconds, _stretches, _begins
    cdef long long _window, _busy, _since, _began
    cpdef void begins(self, long long at)
    cpdef void ends(self, long long at)
    cdef void _pass(self, long long now)
    cpdef object _look(self, long long begin)


cdef class CpuLoad(Load):
    cdef str _unit
    cdef list _under_way
    cpdef long long tag_of(self, object kind, str where, str what)
    cpdef void hear(self, long long tag, long long tick, long long value)


cdef class BusLoad(Load):
    cpdef long long tag_of(self, object kind, str where, str what)
    cpdef void hear(self, long long tag, long long tick, long long value)

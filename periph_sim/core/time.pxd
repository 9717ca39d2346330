cimport cython


@cython.final
cdef class Clock:
    cdef public object timebase, hz
    cdef object _exact
    cdef bint _wide
    cdef long long _tick0, _cycle0, _num, _den, _last_cycle, _last_tick, _near
    cpdef long long tick(self, long long cycle)
    cpdef long long cycle_at(self, long long tick)
    cpdef long long cycle_after(self, long long tick)
    cdef object _wide_ticks(self, object cycles)
    cdef object _wide_cycles(self, object ticks)

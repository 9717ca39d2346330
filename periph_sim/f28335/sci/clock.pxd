cimport cython


@cython.final
cdef class SciClock:
    cdef public bint running
    cdef public long long divider, phase, brr, period
    cdef long long _tick, _cycle, _left
    cpdef long long passed(self, long long now)
    cpdef long long from_cycle(self, long long cycle)
    cpdef long long at(self, long long tick)
    cpdef long long lspclk_after(self, long long now)
    cpdef void set_brr(self, long long now, long long brr, bint at_once)
    cpdef void set_lspclk(self, long long now, long long divider, long long phase)
    cpdef void stop(self, long long now)
    cpdef void start(self, long long now)
    cpdef void restart(self, long long now)
    cpdef void reset(self, long long now)
    cdef void _rebase(self, long long now)

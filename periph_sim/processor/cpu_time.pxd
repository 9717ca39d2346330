cimport cython

from ..core.kernel cimport Event, Kernel
from ..core.time cimport Clock


@cython.final
cdef class CpuTime:
    cdef public long long cycle, lease, lands, met, wakes
    cdef public bint asleep, watching
    cdef Clock _clock
    cdef Kernel _kernel
    cdef Event _wake
    cdef long long _until, _wake_cycle, _wake_tick
    cpdef tuple instant(self)
    cpdef long long left(self)
    cpdef bint advance(self, long long cycle)
    cpdef long long renew(self)
    cpdef bint rest(self, long long cycle)
    cpdef void sleep(self, long long until)
    cpdef void watch(self, long long until)
    cpdef void meet(self)
    cpdef void limit(self, long long lands)
    cpdef void begin(self, long long delay)
    cpdef void arrive(self)
    cpdef void wake_at(self, long long cycle)
    cpdef void resume_by(self, long long cycle)
    cpdef void reclock(self)
    cpdef void stop(self)

cimport cython

from .registers cimport I2cRegisters


cdef class I2cClock:
    cdef public I2cRegisters state
    cdef public long long lines, pulls, due
    cdef public bint frozen, halting, active
    cdef long long _let_go_at, _low_from, _rose_at, _condition_sda, _driven, _step, _after_high, _holds
    cdef bint _waits_for_rise, _high_phase
    cpdef void let_go(self)
    cpdef long long low(self)
    cpdef long long high(self)
    cdef long long _d(self)
    cdef void _at(self, long long now, long long step)
    cdef void _drive(self, long long level)
    cdef void _release_after_low(self, long long now)
    cdef void _release(self, long long now)
    cpdef void hear(self, long long now, long long lines)
    @cython.locals(late=cython.longlong)
    cdef void _rose(self, long long now)
    cdef void _scl_low(self, long long now)
    cdef void _begin_condition(self, long long now, long long sda, long long then)
    cdef void _condition_low(self, long long now)
    cpdef void halt(self, long long now)
    cpdef void resume_after_halt(self, long long now)

from .registers cimport I2cRegisters


cdef class I2cClock:
    cdef public I2cRegisters state
    cdef public long long lines, pulls, due
    cdef public bint frozen, halting, active
    cdef public long long _let_go_at, _low_from, _rose_at, _condition_sda, _driven
    cdef public object _step, _after_high, _holds
    cdef public bint _waits_for_rise, _high_phase
    cpdef long long low(self)
    cpdef long long high(self)
    cdef long long _d(self)
    cpdef void _at(self, long long now, object step)
    cpdef void _drive(self, long long level)
    cpdef void _release_after_low(self, long long now)
    cpdef void hear(self, long long now, long long lines)
    cpdef void _rose(self, long long now)
    cpdef long long _filter(self)
    cpdef void _scl_low(self, long long now)
    cpdef void _begin_condition(self, long long now, long long sda, object then)

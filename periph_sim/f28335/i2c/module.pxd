from ...core.chip cimport Chip
from .limits cimport I2cLimits
from .master cimport I2cMaster
from .noise_filter cimport I2cNoiseFilter
from .registers cimport I2cRegisters
from .slave cimport I2cSlave


cdef class I2c(Chip):
    cdef public object options
    cdef readonly I2cLimits limits
    cdef readonly I2cRegisters state
    cdef readonly I2cSlave target
    cdef readonly I2cMaster master
    cdef public long long _timer
    cdef public bint _clocked
    cdef public long long _pins
    cdef readonly I2cNoiseFilter _lines
    cdef public bint _bus_busy, _suspended
    cdef public long long _frozen_pull
    cdef long long _readable
    cdef long long _looks(self)
    cpdef long long next_output(self)
    cdef void _hear(self, long long now, long long levels)
    cdef void _lines_moved(self, long long now)
    cdef void _advance(self, long long now)
    cdef long long _next_timer(self)
    cdef void _timer_due(self, long long now)
    cdef long long _levels(self)
    cdef void _plan(self)
    cdef void _show(self)
    cdef bint _accessible(self)
    cdef void _loop_and_plan(self, long long now)
    cdef void _write_plain(self, long long now, long long offset, long long value)
    cdef void _write_str(self, long long now, long long value)
    cdef void _write_mdr(self, long long now, long long value)
    cdef void _enable(self, long long now)
    cdef void _disable(self, long long now)

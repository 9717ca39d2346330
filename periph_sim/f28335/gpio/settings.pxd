cimport cython

from ...core.chip cimport Chip


cdef class GpioSettings(Chip):
    cdef public list _periods, _origins
    cdef public dict _stored, _active
    cdef public object _settings, _routes
    cpdef object reset_registers(self)
    cpdef object restart_sampling(self, long long now)
    cpdef object take_over(self, long long now)
    @cython.locals(control=cython.longlong, port=cython.longlong)
    cdef void _take_periods(self, long long now)
    @cython.locals(pins=object, i=cython.longlong)
    cdef object _ports(self, tuple offsets)

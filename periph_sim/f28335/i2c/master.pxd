cimport cython

from .limits cimport I2cLimits
from .master_transmitter cimport I2cMasterTransmitter


@cython.final
cdef class I2cMaster(I2cMasterTransmitter):
    cdef public I2cLimits limits
    cdef public bint sees_idle
    cdef bint _waits_for_bus, _starting, _stopping, _own_restart
    cdef list _addresses, _restart_next
    cdef long long _free_from
    cpdef void reset(self)
    cpdef void timer(self, long long now)
    cpdef bint answers_edges(self)
    cpdef void command(self, long long now, long long written)
    cdef void _request_bus(self, long long now)
    cpdef void start_seen(self, long long now)
    cpdef void stop_seen(self, long long now)
    cdef void _meets_foreign_condition(self, long long now)
    cdef void _start(self, long long now)
    cdef void _begin_start(self, long long now)
    cdef void _take_command(self)
    cdef void _started(self, long long now)
    cpdef void load_counter(self)
    cdef list _address_bytes(self)
    cdef void _next_address(self, long long now)
    @cython.locals(level=cython.longlong)
    cdef void _set_sda(self, long long now)
    cpdef void fell(self, long long now)
    cpdef void rise(self, long long now, long long sda)
    cdef void _fall(self, long long now)
    cdef void _byte_over(self, long long now)
    cdef void _address_over(self, long long now, bint ack)
    cdef bint _leaves_scl_high(self)
    cdef void _stop_if_allowed(self, long long now)
    cdef void _stop_high(self)
    cdef void _restart_high(self, long long now)
    cdef void lose(self, long long now)

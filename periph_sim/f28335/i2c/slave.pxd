cimport cython

from .slave_transmitter cimport I2cSlaveTransmitter


@cython.final
cdef class I2cSlave(I2cSlaveTransmitter):
    cpdef bint follows(self)
    cpdef long long silent_edges(self, bint high)
    cpdef void start(self, long long now)
    cpdef void stop(self, long long now)
    cpdef void rise(self, long long now, long long sda)
    cpdef void fall(self, long long now)
    cpdef void _last_rise(self, long long now)
    cpdef void _address_complete(self, long long now)
    cpdef void _address_flags(self, long long now)
    cpdef object _policy(self)
    cdef bint _stretches(self, str point)
    cpdef void _data_complete(self, long long now)
    cpdef void _take(self, long long now)
    cpdef long long _value(self)
    cpdef void _ack_rise(self, long long now)
    cpdef void drr_read(self, long long now)
    cpdef void _slot_ends(self, long long now)
    cpdef void _data_slot_ends(self, long long now)
    cpdef void _nack_was_sent(self, long long now)
    cpdef void _next_byte(self, long long now)
    cpdef void _let_go(self)
    cpdef void reset(self)
    cpdef void release_bus(self)

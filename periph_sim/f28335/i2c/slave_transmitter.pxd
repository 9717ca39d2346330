from ...core.options cimport TextOption
from .address cimport I2cAddress
from .registers cimport I2cRegisters


cdef class I2cSlaveTransmitter:
    cdef public I2cRegisters state
    cdef public long long pulls, due, phase, bit
    cdef public bint muted, own_transfer
    cdef public I2cAddress _address
    cdef TextOption _copy_point
    cdef public long long _n, _shift, _copy_at, _release_at, _sent
    cdef public bint _ack, _nack_armed, _waits_for_data, _waits_for_room, _rsr_waits, _first_byte, _shifting
    cpdef bint _copy(self, long long now, bint xrdy=*)
    cdef bint _copies_at(self, str point)
    cdef bint _copies_at_once(self)
    cpdef void _eager(self, long long now)
    cpdef void dxr_written(self, long long now)
    cpdef void _release(self, long long now)
    cpdef void timer(self, long long now)
    cpdef void _begin_byte(self, long long now, bint first)
    cpdef void _underflow(self, long long now, bint first)
    cpdef void _send(self, long long now)
    cpdef void _drive(self, long long level)
    cpdef void _answered(self, long long now, long long sda)
    cpdef void _copy_at_rise9(self, long long now)

from .master_receiver cimport I2cMasterReceiver


cdef class I2cMasterTransmitter(I2cMasterReceiver):
    cdef void _begin_byte(self, long long now, long long byte, long long n)
    cdef void _next_data(self, long long now)
    cpdef void dxr_written(self, long long now)
    cdef void _sent(self, long long now, bint ack)
    cdef void _done(self, long long now)
    cdef void _loop_back(self, long long now)

from .clock cimport I2cClock


cdef class I2cMasterReceiver(I2cClock):
    cdef public long long counter, deliver_at
    cdef long long _kind, _n, _bit, _byte, _in, _sampled, _data_bytes, _deliver
    cdef bint _answer_nack, _nack_armed, _stp_at_start, _rsr_waits
    cpdef void reset_bytes(self)
    cdef void _next_data(self, long long now)
    cdef void _done(self, long long now)
    cdef void _stop(self, long long now)
    cdef void _restart(self, long long now, bint own)
    cdef void _refused(self, long long now)
    cdef bint _repeat(self)
    cdef void _choose_answer(self)
    cdef void _take(self, long long now)
    cdef void _received(self, long long now, long long value)
    cdef void _taken(self, long long now)
    cdef void _after_taken(self, long long now)
    cpdef void drr_read(self, long long now)

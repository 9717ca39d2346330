cdef class I2cInterrupts:
    cdef public long long str, ier, isrc_high, requests, held, code, code_at
    cdef public bint wanted, nack_as_slave
    cdef public object options
    cdef public list notes
    cdef public set touched
    cdef long long _pending, _active
    cpdef void set(self, long long now, long long flags)
    cpdef void clear(self, long long now, long long flags)
    cpdef long long sources(self)
    cpdef void update(self, long long now)
    cdef bint _outranks(self)
    cdef long long _first(self)
    cpdef void load_code(self, long long now)
    cdef void _show(self, long long now, long long code)
    cpdef long long read_isrc(self, long long now)

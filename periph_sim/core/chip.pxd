cdef class Chip:
    cdef public long long next_wake, out, requests, held, filter_width, writes, loaded
    cdef public list notes
    cdef public set touched
    cpdef long long pins(self, long long now, long long levels)
    cpdef long long wake(self, long long now)
    cpdef long long next_output(self)
    cpdef long long read(self, long long now, long long offset)
    cpdef void write(self, long long now, long long offset, long long value)
    cpdef long long peek(self, long long now, long long offset)
    cpdef long long see(self, long long now, long long offset)
    cpdef void reset(self, long long now)

cimport cython


@cython.final
cdef class FetchQueue:
    cdef public long long expected
    cdef public long long packed_queue[10]
    cdef long long _consumed[4]
    cdef long long _newest, _ready, _bits, _cycles, _issued, _place
    @cython.locals(place=cython.longlong)
    cpdef void pack(self, long long cycle)
    cpdef void begin(self, long long cycle, long long address, long long bits, long long first, long long later, long long depth)
    @cython.locals(ready=cython.longlong)
    cpdef long long wait(self, long long cycle, long long address, long long behind)
    @cython.locals(free=cython.longlong, place=cython.longlong)
    cdef long long _need(self, long long unit)
    @cython.locals(place=cython.longlong, ready=cython.longlong, unit=cython.longlong, free=cython.longlong,
                   begins=cython.longlong)
    cpdef long long read(self, long long cycle, long long waits)

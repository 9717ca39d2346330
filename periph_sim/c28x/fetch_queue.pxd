cimport cython


@cython.final
cdef class FetchQueue:
    cdef public long long expected
    cdef long long _consumed[4]
    cdef long long _newest, _ready, _bits, _cycles, _issued
    cpdef void begin(self, long long cycle, long long address, long long bits, long long first, long long later)
    @cython.locals(ready=cython.longlong)
    cpdef long long wait(self, long long cycle, long long address, long long behind)
    @cython.locals(free=cython.longlong)
    cdef long long _need(self, long long unit)

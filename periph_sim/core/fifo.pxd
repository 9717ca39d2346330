cimport cython


@cython.final
cdef class Fifo:
    cdef public long long depth
    cdef public list words
    cpdef bint push(self, long long word)
    cpdef long long pop(self)
    cpdef void clear(self)

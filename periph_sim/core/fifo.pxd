cdef class Fifo:
    cdef public long long depth
    cdef public object words
    cpdef bint push(self, long long word)
    cpdef long long pop(self)
    cpdef void clear(self)

cimport cython


@cython.final
cdef class HighRam:
    cdef unsigned short words[32768]


@cython.final
cdef class Ram:
    cdef unsigned short _low[4096]
    cdef HighRam _high
    cpdef long long word(self, long long address)
    cpdef void put(self, long long address, long long value)
    cpdef list words(self, long long address, long long count)
    cpdef void put_words(self, long long address, object values)
    cpdef long long word32(self, long long address)
    cpdef void put_word32(self, long long address, long long value)

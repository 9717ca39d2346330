from .polling cimport Spin


cdef class Program:
    cdef public Spin spin
    cdef public long long polls_skipped
    cdef public object returned_at
    cpdef object run(self, long long until)
    cpdef object place(self)
    cpdef object enter(self, long long vector)
    cpdef object context(self)
    cpdef void restore(self, object words)
    cpdef void kill(self, object how)

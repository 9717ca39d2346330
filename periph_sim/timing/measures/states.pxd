cimport cython

from .event_pairing cimport EventMeasure, Hearing


cdef class _InState(EventMeasure):
    cdef public object state
    cdef long long _enters, _since
    @cython.locals(plan=list, one=Hearing, enters=cython.bint, leaves=cython.bint)
    cpdef void hear(self, long long tag, long long tick, long long value)
    cpdef void begins(self, long long at, bint seen)
    cpdef void ends(self, long long at)


cdef class TimeIn(_InState):
    cpdef void begins(self, long long at, bint seen)
    cpdef void ends(self, long long at)


cdef class EachTimeIn(_InState):
    cdef bint _whole
    cpdef void begins(self, long long at, bint seen)
    cpdef void ends(self, long long at)

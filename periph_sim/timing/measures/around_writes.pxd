cimport cython

from ...traces.formats.record_table cimport Columns


cdef class Access:
    cdef public long long tag, number, tick, value, cause
    cdef public object text
    cdef public str field


cdef class UnitAccesses:
    cdef public list recent, last


cdef class Topic:
    cdef public long long role
    cdef public UnitAccesses unit
    cdef public dict last


cdef class AroundWrites(Columns):
    cdef object _concerns
    cdef long long _back
    cdef list _of
    cdef dict _units
    cpdef long long tag_of(self, object kind, str where, str what)
    cpdef long long places(self, long long tag)
    @cython.locals(topic=Topic, unit=UnitAccesses, recent=list, old=Access, of=Topic, one=Access, last=dict, passed=cython.longlong)
    cpdef void keep(self, long long tag, long long number, long long tick, long long value, object text, long long cause, object field)
    cdef void _stays(self, Access one)

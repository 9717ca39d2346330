cimport cython

from ...traces.formats.record_table cimport Columns


cdef class UnitAccesses:
    cdef public object recent
    cdef public dict last


cdef class AroundWrites(Columns):
    cdef long long _back
    cdef list _roles, _unit_of
    cdef dict _units
    cpdef long long tag_of(self, object kind, str where, str what)
    @cython.locals(role=cython.longlong, unit=UnitAccesses, old=tuple, at=cython.longlong)
    cpdef void keep(self, long long tag, long long number, long long tick, long long value, object text, long long cause, object field)

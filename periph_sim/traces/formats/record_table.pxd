cimport cython

from ...core.records cimport Keeper


@cython.final
cdef class _Strings:
    cdef object text, field
    cdef unsigned int text_place, field_place


cdef class Columns(Keeper):
    cdef dict _topics
    cdef list _last
    cdef list _full
    cdef dict _block
    cdef dict _texts, _fields
    cdef unsigned int[::1] _tags, _text_places, _field_places
    cdef long long[::1] _numbers, _ticks, _values, _causes
    cdef Py_ssize_t _filled
    @cython.locals(last=_Strings)
    cpdef void clear(self)
    cdef object _begin(self)
    cdef long long _place(self, dict places, object text)
    cpdef long long tag_of(self, object kind, str where, str what)
    @cython.locals(row=cython.Py_ssize_t, last=_Strings)
    cpdef void keep(self, long long tag, long long number, long long tick, long long value, object text, long long cause, object field)

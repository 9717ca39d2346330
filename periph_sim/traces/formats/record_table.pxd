from cpython.array cimport array

from ...core.records cimport Keeper


cdef class Columns(Keeper):
    cdef dict _topics
    cdef array _topic, _number, _tick, _value, _cause, _text, _field
    cdef object _texts, _fields
    cpdef long long tag_of(self, object kind, str where, str what)
    cpdef void keep(self, long long tag, long long number, long long tick, long long value, object text, long long cause, object field)

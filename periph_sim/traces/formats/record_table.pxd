from ...core.records cimport Keeper


cdef class Columns(Keeper):
    cdef dict _topics
    cdef object _topic, _number, _tick, _value, _cause, _text, _field, _texts, _fields
    cdef list _topic_waits, _number_waits, _tick_waits, _value_waits, _cause_waits, _text_waits, _field_waits
    cdef long long _waiting
    cdef object _wait(self)
    cdef object _put(self)
    cpdef long long tag_of(self, object kind, str where, str what)
    cpdef void keep(self, long long tag, long long number, long long tick, long long value, object text, long long cause, object field)

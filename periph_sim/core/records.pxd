cdef class Recorder:
    cdef public long long cause
    cdef long long _number
    cdef dict _sinks, _subjects
    cdef set _of_all
    cpdef object carried(self, object action)
    cpdef object _under(self, long long cause, object action)
    cpdef long long emit(self, long long tick, object kind, object where, object what, object value=*, object text=*, object field=*)

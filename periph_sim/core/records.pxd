cimport cython


cdef class Listener:
    cpdef long long tag_of(self, object kind, str where, str what)
    cpdef void hear(self, long long tag, long long tick, long long value)


cdef class Keeper:
    cpdef long long tag_of(self, object kind, str where, str what)
    cpdef long long places(self, long long tag)
    cpdef void keep(self, long long tag, long long number, long long tick, long long value, object text, long long cause, object field)


@cython.final
cdef class _Ear:
    cdef public Listener listener
    cdef public long long tag
    cdef public _Ear following


@cython.final
cdef class _Pen:
    cdef public Keeper keeper
    cdef public long long tag
    cdef public _Pen following


@cython.final
cdef class Topic:
    cdef public bint heard, told_whole
    cdef public long long places
    cdef Recorder _recorder
    cdef object _kind
    cdef str _where, _what
    cdef _Ear _ears, _last_ear
    cdef _Pen _pens, _last_pen
    cdef list _sinks
    @cython.locals(ear=_Ear, pen=_Pen)
    cpdef object add(self, object party)
    @cython.locals(ear=_Ear, pen=_Pen, number=cython.longlong, cause=cython.longlong)
    cpdef long long emit(self, long long tick, long long value=*, object text=*, object field=*)


@cython.final
cdef class Recorder:
    cdef public long long cause, number
    cdef dict _topics, _parties, _subjects
    cdef set _of_all
    cpdef Topic topic(self, object kind, str where, str what)
    cpdef object carried(self, object action)
    cpdef object _under(self, long long cause, object action)
    @cython.locals(topic=Topic)
    cpdef long long emit(self, long long tick, object kind, object where, object what, object value=*, object text=*, object field=*)

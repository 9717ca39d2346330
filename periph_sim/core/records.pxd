cimport cython


cdef class Listener:
    cpdef long long tag_of(self, object kind, str where, str what)
    cpdef void hear(self, long long tag, long long tick, long long value)


cdef class Keeper:
    cpdef long long tag_of(self, object kind, str where, str what)
    cpdef long long places(self, long long tag)
    cpdef void keep(self, long long tag, long long number, long long tick, long long value, object text, long long cause, object field)


@cython.final
cdef class _ListenerEntry:
    cdef public Listener listener
    cdef public long long tag
    cdef public _ListenerEntry following


@cython.final
cdef class _KeeperEntry:
    cdef public Keeper keeper
    cdef public long long tag
    cdef public _KeeperEntry following


@cython.final
cdef class Topic:
    cdef public bint heard, told_whole
    cdef public long long places
    cdef Recorder _recorder
    cdef object _kind
    cdef str _where, _what
    cdef _ListenerEntry _listeners, _last_listener
    cdef _KeeperEntry _keepers, _last_keeper
    cdef list _sinks
    @cython.locals(subscriber=_ListenerEntry, writer=_KeeperEntry)
    cpdef object add(self, object party)
    @cython.locals(subscriber=_ListenerEntry, writer=_KeeperEntry, number=cython.longlong, cause=cython.longlong)
    cpdef long long emit(self, long long tick, long long value=*, object text=*, object field=*)


@cython.final
cdef class Recorder:
    cdef public long long cause, number
    cdef dict _topics, _parties, _subjects
    cdef set _of_all
    cpdef Topic topic(self, object kind, str where, str what)
    cpdef object carried(self, object action)
    cpdef object _under(self, long long cause, object action)
    cpdef long long emit(self, long long tick, object kind, object where, object what, object value=*, object text=*, object field=*)

cimport cython

from ...core.records cimport Keeper


cdef class ClearedRegister


@cython.final
cdef class Modify:
    cdef public long long number, tick, written, cleared
    cdef public object place
    cdef public list rose


@cython.final
cdef class Access:
    cdef public long long number, tick, value, cause
    cdef public bint reads
    cdef public object text
    cdef public str field
    cdef public ClearedRegister register
    cdef public Modify modify
    cdef public Access before, after


@cython.final
cdef class Recent:
    cdef public Access oldest, newest


@cython.final
cdef class Flag:
    cdef public str name
    cdef public long long mask, rose
    cdef public ClearedRegister register


@cython.final
cdef class Cleared:
    cdef public long long count, first
    cpdef void add(self, long long count, long long first)


@cython.final
cdef class Look:
    cdef public str field
    cdef public long long number
    cdef public Look following


@cython.final
cdef class Looks:
    cdef Look _first
    @cython.locals(look=Look)
    cpdef void add(self, str field, long long number)
    @cython.locals(look=Look, last=cython.longlong)
    cpdef long long last(self, str field)


@cython.final
cdef class Place:
    cdef public Looks looks
    cdef public long long proven, always
    cdef public set named
    cdef public dict between, along, unseen


@cython.final
cdef class ClearedRegister:
    cdef public list flags
    cdef public bint status
    cdef public Looks looks
    cdef public dict places
    cdef public Modify last
    @cython.locals(flag=Flag)
    cpdef Flag flag(self, str name)
    @cython.locals(last=cython.longlong, other=Place)
    cpdef long long looked_at(self, Flag flag, object place)


@cython.final
cdef class Topic:
    cdef public bint reads
    cdef public Recent recent
    cdef public ClearedRegister register
    cdef public Flag flag


cdef class Modifies(Keeper):
    cdef public long long writes
    cdef object _concerns, _is_about
    cdef bint _status
    cdef long long _longest
    cdef list _clocks, _topics
    cdef object _per_second
    cdef long long _known
    cdef Access _spare
    cdef public dict recent
    cdef dict _registers
    @cython.locals(register=ClearedRegister, flag=Flag, unit=str, module=str, name=str, field=str)
    cpdef long long tag_of(self, object kind, str where, str what)
    cdef ClearedRegister _register(self, str unit, str name)
    cpdef long long places(self, long long tag)
    @cython.locals(topic=Topic, register=ClearedRegister, recent=Recent, one=Access, newest=Access, before=cython.longlong)
    cpdef void keep(self, long long tag, long long number, long long tick, long long value, object text, long long cause, object field)
    @cython.locals(last=Modify)
    cdef void _moved(self, Flag flag, long long number, long long tick, long long value, long long cause)
    @cython.locals(one=Access, made=Modify, passed=cython.Py_ssize_t)
    cdef void _landed(self, Access write, ClearedRegister register, Recent recent)
    @cython.locals(one=Access, after=Access, made=Modify, register=ClearedRegister)
    cdef void _forget(self, Recent recent, long long before)
    @cython.locals(place=Place, flag=Flag, number=cython.Py_ssize_t)
    cdef void _judge(self, ClearedRegister register, Access read, Modify made)


@cython.locals(of=Cleared)
cdef void _one_more(dict cleared, Flag flag, Modify made)
cdef bint _alike(Access read, Access write)

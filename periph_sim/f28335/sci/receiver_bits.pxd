cimport cython

from .character_format cimport SciFormat


@cython.final
cdef class SciRxBits:
    cdef public long long next_tick, word, address
    cdef public bint watch_idle, framed
    cdef SciFormat _layout, _frame
    cdef object _options
    cdef bint _open, _idle, _idle_news, _sure
    cdef set _touched
    cdef list _toggles
    cdef long long _line, _level, _low_from, _high_from, _idle_base, _start, _missing_stop, _break_at
    cpdef bint toggle(self, long long tick, long long level)
    @cython.locals(start=cython.longlong, frame=SciFormat, toggles=list)
    cpdef long long complete_at(self, long long fall, long long second)
    cpdef void set_layout(self, long long tick, SciFormat layout, bint at_once)
    cpdef void set_watch(self, long long tick, bint watch)
    cpdef void settle(self, long long tick)
    cpdef void open(self, long long tick)
    cpdef void close(self)
    cpdef long long step(self, long long tick)
    @cython.locals(end=cython.longlong)
    cdef void _hunt(self, long long tick)
    cdef void _turn(self, long long tick)
    @cython.locals(t=cython.longlong)
    cdef void _end_break_on_high(self, long long tick)
    cdef void _wait_for_high(self)
    @cython.locals(t=cython.longlong, third=cython.longlong, fourth=cython.longlong, fifth=cython.longlong, stop=cython.longlong)
    cdef void _finish(self)
    cdef void _read_word(self, long long votes, long long stop, SciFormat frame)
    cdef void _after_missing_stop(self, long long stop, long long start, SciFormat frame)
    @cython.locals(t=cython.longlong, passed=cython.longlong)
    cdef void _drop(self, long long tick)
    cdef void _resume(self, long long tick)
    @cython.locals(end=cython.longlong, due=cython.longlong)
    cdef void _plan(self)

cimport cython

from .chip cimport Chip
from .chip_input cimport Input
from .kernel cimport Agent, Event, Kernel
from .records cimport Recorder
from .shortcuts cimport Untold
from .time cimport Clock
from .watched_register cimport WatchedField, WatchedRegister
from .wire cimport Pin, Sampler


cdef class Release:
    cpdef bint holds_back(self)
    cpdef void pulls(self)


cdef class Onlooker:
    cpdef void look(self, long long cycle)


@cython.final
cdef class Socket(Agent):
    cdef public str name
    cdef public Chip chip
    cdef public list pins, watchers, notes
    cdef public Sampler inputs
    cdef public Release release
    cdef public Untold untold
    cdef public object marks, before, after, on_held, on_watch, on_note, on_peek
    cdef public long long out_delay
    cdef public bint traces
    cdef bint _some_data, _some_steady
    cdef Kernel _kernel
    cdef Clock _clock
    cdef Recorder _recorder
    cdef object _on_request
    cdef long long _out, _held, _wake_cycle, _last_cause
    cdef Event _wake
    cdef list _watched, _moving, _looked
    cdef long long _writes, _inputs, _mid_byte
    cdef Input _first_input, _last_input, _spare
    cdef object _touched
    cdef dict _note_count
    cpdef long long read(self, long long cycle, long long offset)
    cpdef long long peek(self, long long cycle, long long offset)
    cpdef long long see(self, long long cycle, long long offset)
    cpdef void write(self, long long cycle, long long offset, long long value)
    @cython.locals(given=Input, before=Input, after=Input, cause=cython.longlong)
    cpdef void given(self, long long cycle)
    @cython.locals(first=Input)
    cdef void _take_first(self)
    cdef void _woken(self)
    cdef long long _cause_at(self, long long cycle)
    cpdef void publish(self, long long cycle, long long looks=*)
    cdef void _request(self, long long cycle)
    @cython.locals(watcher=Onlooker)
    cdef void _show(self, long long cycle)
    cdef void _plan(self, long long cycle)
    cdef void _drive(self, long long cycle)
    cdef void _move(self, long long cycle, long long index, long long level)
    cpdef void move(self, long long cycle, long long index, long long level)
    @cython.locals(pin=Pin, pins=list)
    cpdef object _set_pins(self, long long index, long long level)
    cpdef void watch(self, Onlooker watcher)
    cpdef void unwatch(self, Onlooker watcher)
    cdef void _have_watch(self, list watchers)
    cpdef bint looked_at(self)
    cpdef void reclock(self)
    @cython.locals(register=WatchedRegister)
    cdef bint _look(self, long long cycle)
    @cython.locals(register=WatchedRegister, field=WatchedField, changed=cython.longlong, loaded=cython.longlong)
    cdef void _record_flags(self, long long cycle)
    cdef void _take_notes(self, long long cycle)

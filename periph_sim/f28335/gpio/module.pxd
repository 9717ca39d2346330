cimport cython

from ...core.options cimport IntOption
from .qualifier cimport Qualifier
from .settings cimport GpioSettings


@cython.final
cdef class Gpio(GpioSettings):
    cdef public object pads, watched, driven, driven_high
    cdef public long long out_version, routes_version
    cdef public IntOption gpio_out_delay
    cdef public list changed
    cdef object _wired, _before, _qualified, _latch, _asynchronous, _sampled, _dead, _pull_ups, _outputs, _settles
    cdef long long _edge_at, _watching, _xints, _settle_at
    cdef bint _input_clock
    cdef dict _qualifiers
    cdef list _waiting, _outs, _words_then
    cdef object _level_then, _pads_then, _qualified_then
    cdef list _words(self, long long now)
    cpdef void edges(self, long long now, object levels, bint exact=*)
    cpdef bint only_shows(self, object pads)
    cpdef void moved_before(self, object pads)
    cdef void _catch_up(self, long long now)
    @cython.locals(qualifier=Qualifier)
    cdef void _step(self, long long now)
    @cython.locals(qualifier=Qualifier, when=cython.longlong)
    cdef void _plan(self)
    cdef void _flip(self, long long now, object bits, bint exact)
    cdef object _synchronised(self, long long now)
    cdef object _shown(self, long long now)
    cdef void _tell_xints(self, long long now)
    cdef void _write_data(self, long long offset, object word)
    cpdef long long seen_at(self, long long now, long long index, bint exact)
    cpdef object source(self, str signal)
    cpdef object sink(self, str signal)
    cpdef long long peripheral_level(self, long long now, str signal)
    cdef void _take_settings(self, long long now)
    cdef void _configure(self, long long now)
    @cython.locals(qualifier=Qualifier, pin=cython.longlong, samples=cython.longlong, line=cython.longlong)
    cdef void _update_paths(self, long long now)
    @cython.locals(qualifier=Qualifier)
    cdef void _update_sampler(self, long long now, long long pin, long long samples, long long shown)
    cdef void _tell_signals(self, long long now, object routes, object shown)
    cdef void _drive(self, long long now)
    cdef void _follow_drive(self, long long now)

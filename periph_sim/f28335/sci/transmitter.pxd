cimport cython

from ...core.fifo cimport Fifo
from .character_format cimport SciFormat
from .clock cimport SciClock
from .transmitter_bits cimport SciTxBits


@cython.final
cdef class SciTx:
    cdef public object options
    cdef public set touched
    cdef public SciTxBits bits
    cdef public Fifo fifo
    cdef public list sent, lost
    cdef public bint request, word_line, enabled, running, in_swreset, stopping, int_enabled, txwake, wut, fifo_mode, active
    cdef public long long frames, mark, out_mark, delay, txbuf, scifftx, next_tick, next_cycle
    cdef SciClock _clock
    cdef SciFormat _layout
    cdef bint _waiting, _loaded, _data_frame, _reached
    cdef long long _drain, _txshf, _txbuf_mark, _txshf_mark, _began, _end, _last_end, _start_at, _load_at, _load_cycle
    cdef long long _empty_until
    cpdef void run(self, long long now)
    cpdef void replan(self, long long now)
    cpdef void edges_moved(self, long long now)
    cpdef void resume(self, long long now)
    cdef void _finish(self)
    cdef void _plan(self, long long now)
    cdef void _plan_behind(self, long long now)
    cdef void _plan_from_idle(self, long long now)
    cdef long long _pause(self)
    cdef bint _may_load(self)
    cdef void _load(self)
    cdef void _start(self, long long now)
    cdef void _send(self, long long tick)
    cdef long long _levels(self, SciFormat layout)
    cdef void _set_next(self, long long now)
    cpdef void write_buffer(self, long long now, long long value)
    cdef void _to_fifo(self)
    cpdef void write_fifo(self, long long now, long long value)
    cpdef void watch_level(self)
    cdef bint _is_held(self)
    cpdef void set_enabled(self, long long now, bint on)
    cpdef void set_int_enabled(self, bint on)
    cpdef void set_layout(self, long long now, SciFormat layout, bint at_once)
    cpdef long long show_flags(self, long long now)
    cpdef long long show_fifo(self)
    cdef bint _is_empty(self)
    cpdef void halt(self)
    cpdef void release(self, long long now)
    cpdef void clear_fifo(self)
    cpdef void reset(self)

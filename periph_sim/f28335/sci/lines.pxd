from ...core.chip cimport Chip
from .autobaud cimport SciAutobaud
from .character_format cimport SciFormat
from .clock cimport SciClock
from .receiver cimport SciRx
from .receiver_bits cimport SciRxBits
from .transmitter cimport SciTx


cdef class SciLines(Chip):
    cdef public str name
    cdef public object options
    cdef SciFormat _layout
    cdef SciClock _rx_clock, _tx_clock
    cdef SciRxBits _bits
    cdef SciRx _rx
    cdef SciTx _tx
    cdef SciAutobaud _autobaud
    cdef long long _sync, _rxd, _ccr, _ctl1, _hbaud, _lbaud, _ffct, _pri, _rx_at, _tx_at, _request_at
    cdef bint _gated, _suspended, _rx_stopping, _abd_asked, _listening
    cdef bint _word_line
    cpdef void deliver(self, long long now, long long word, long long address_bit=*)
    cpdef void deliver_break(self, long long now)
    cpdef list take_words(self)
    @cython.locals(clock=SciClock, complete=cython.longlong)
    cpdef bint hears_whole(self, long long first, long long second, long long last)
    cpdef list coming_edges(self)
    cpdef void take_edges(self, long long now)
    cpdef void give_back_edges(self, long long now, long long count)
    cdef void _resume_edges(self, long long now)
    cpdef void gate(self, long long now, bint on)
    cpdef void set_lspclk(self, long long now, long long divider, long long phase)
    cpdef void suspend(self, long long now, bint on)
    cdef void _set_clocks(self, long long now, bint tx_finishes)
    cdef void _line(self, long long now, long long level)
    cdef void _run(self, long long now)
    cdef void _schedule(self)
    cdef void _replan(self)
    cdef void _plan_tx(self)
    cdef void _run_tx(self, long long at)
    cdef void _set_out(self, long long now)
    cdef void _run_rx(self, long long at)
    cdef void _move(self, long long now, long long word, long long address)
    cdef void _load_received(self)
    cdef bint _is_break_like(self, long long word, long long address)
    cdef void _take_break(self, long long now)
    cdef void _request_rx(self, long long now)
    cdef void _watch_idle(self, long long now)
    cdef void _finish_autobaud(self, long long at)
    cdef void _set_abd(self)
    cdef void _arm_receiver(self, long long now)
    cdef void _note(self, str code, str text, str source)
    cdef void _set_brr(self, long long now)

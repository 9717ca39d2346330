cimport cython

from ...core.fifo cimport Fifo


@cython.final
cdef class SciRx:
    cdef public object options
    cdef public set touched
    cdef public bint request, loaded, enabled, sleep, bk_enabled, error_enabled, fifo_mode, parity
    cdef public long long status, rxbuf, sciffrx
    cdef public Fifo fifo
    cdef bint _reached
    cpdef void deliver(self, long long word, long long address, bint break_like)
    cpdef void line_idle(self)
    cpdef bint line_break(self)
    cdef void _pass_in_sleep(self, long long word)
    cdef long long _to_fifo(self, long long word)
    cdef void _set_errors(self, long long errors, bint keep=*)
    cdef void _watch_level(self)
    cpdef long long show_status(self)
    cpdef long long show_buffer(self)
    cpdef long long show_fifo(self)
    cpdef long long read_buffer(self)
    cpdef void write_fifo(self, long long value)
    cpdef void set_enables(self, bint bk_enabled, bint error_enabled)
    cpdef void set_fifo_mode(self, bint on)
    cpdef void clear_flags(self)
    cpdef void clear_fifo(self)
    cpdef void reset(self)

from .lines cimport SciLines


cdef class Sci(SciLines):
    cdef void _after_write(self, long long now)
    cdef long long _read_rxbuf(self, long long now)
    cdef long long _show(self, long long now, long long offset)
    cdef void _check_offset(self, long long offset)
    cdef bint _no_clock(self, str what)
    cdef void _write_ccr(self, long long now, long long value)
    cdef void _write_ctl1(self, long long now, long long value)
    cdef void _enter_swreset(self)
    cdef void _write_fftx(self, long long now, long long value)
    cdef void _set_running(self, long long now)
    cdef void _write_ffct(self, long long now, long long value)

cimport cython

from .fifos cimport I2cFifos


@cython.final
cdef class I2cRegisters(I2cFifos):
    cdef public long long bcm, clkh, clkl, cnt, drr, dxr, filter_width, loaded, oar, psc, rsr, sar, tm, xsr, nack_since
    cdef public bint drr_unread, dxr_full, emdr_written
    cdef public object nack_of
    cdef public list dxr_behind
    cpdef bint tx_ready(self)
    cpdef void write_dxr(self, long long now, long long value)
    cdef bint _extra_stage(self)
    cpdef bint copy_to_xsr(self, long long now, bint xrdy=*)
    cpdef bint rx_blocked(self)
    cdef bint rrdy_rises_at(self, str edge)
    cpdef void received(self, long long now, long long value)
    cpdef long long read_drr(self, long long now)
    cpdef long long stored(self, long long offset)
    @cython.locals(registers=cython.longlong, levels=cython.longlong)
    cpdef long long readable(self)
    cpdef long long bits(self)
    cpdef bint trx(self)
    cpdef long long setup(self)
    cpdef void nack_received(self, long long now, bint as_slave, object of)
    cpdef void overrun(self, long long now)

from ...core.fifo cimport Fifo
from .interrupts cimport I2cInterrupts


cdef class I2cFifos(I2cInterrupts):
    cdef public long long fftx, ffrx, mdr
    cdef public bint fifo, xsr_full
    cdef public Fifo tx_fifo, rx_fifo
    cdef bint _tx_was_low, _rx_was_high
    cpdef void fifo_levels(self, long long now)
    cdef long long _level_flag(self, long long register, bint condition, bint before)

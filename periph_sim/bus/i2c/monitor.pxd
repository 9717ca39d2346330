cimport cython

from ...core.wire cimport Wire
from .transfer cimport Phase, Transfer
from .whole_bytes cimport ByteParty


@cython.final
cdef class I2cMonitor(ByteParty):
    cdef Wire _scl, _sda
    cdef object _told, _names
    cdef Transfer _transfer
    cdef Phase _phase
    cdef long long _start_at, _starting, _scl_mask, _sda_mask, _began_at, _let_go_at, _rose_at, _ended_at, _pulled_at
    cdef long long _clock_length, _index, _bits, _in, _filter, _sda_at, _sda_seen, _levels, _stretch
    cdef bint _pulls_scl, _pulls_sda, _first, _reads, _acked
    cdef list _acks
    cdef bytearray _got
    cdef void _first_clock(self, long long now)
    cdef tuple _versions
    cdef dict _masters_of
    cdef tuple _masters(self)
    cdef void _condition(self, long long now, long long before, long long levels)
    cdef bint _given_up(self, long long now)
    cdef void _phase_begins(self, long long at)
    cdef void _over(self, long long at)
    @cython.locals(stretch=cython.longlong)
    cdef void _clock(self, long long now, long long before, long long levels, bint pulls)
    cdef void _bit_over(self, long long now, long long bit)
    @cython.locals(phase=Phase, transfer=Transfer)
    cdef void _byte_over(self, long long now)

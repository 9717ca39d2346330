from ...core.wire cimport Sampler, Wire
from .whole_bytes cimport ByteParty


cdef class I2cMonitor(ByteParty):
    cdef Wire _scl, _sda
    cdef Sampler _sampler
    cdef object _told, _names, _transfer, _phase
    cdef long long _start_at, _starting, _scl_mask, _sda_mask, _began_at, _let_go_at, _rose_at, _ended_at, _pulled_at
    cdef long long _clock_length, _index, _bits, _in, _filter, _sda_at, _sda_seen, _levels
    cdef bint _pulls_scl, _pulls_sda, _first
    cpdef void pulled(self, long long line, long long now, long long pulling)
    cpdef void sampled(self, long long now, long long levels)
    cdef void _first_clock(self, long long now)
    cdef void _condition(self, long long now, long long before, long long levels)
    cdef bint _given_up(self, long long now)
    cdef void _phase_begins(self, long long at)
    cdef void _over(self, long long at)
    cdef void _clock(self, long long now, long long before, long long levels, bint pulls)
    cdef void _bit_over(self, long long now, long long bit)
    cdef void _byte_over(self, long long now)
    cpdef void edge(self, long long tick, long long levels)
    cpdef void heard(self, long long shown, long long rise, long long low, long long high)

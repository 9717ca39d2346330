from ...bus.i2c.bit_times cimport BitTimes
from ...bus.i2c.whole_bytes cimport ByteParty
from ...core.wire cimport Wire


cdef class BusFromWires(ByteParty):
    cdef public long long address, index, phase_at, others_held_until
    cdef public bint read, ours
    cdef str _unit
    cdef Wire _scl_wire, _sda_wire
    cdef long long _scl, _sda, _scl_pulling, _sda_pulling, _scl_ours, _sda_ours, _parties, _tick, _scl_before, _sda_before
    cdef long long _bits, _in
    cdef bint _settled, _acked
    cpdef void pulled(self, long long line, long long now, long long pulling)
    cpdef void heard(self, long long shown, BitTimes times)
    cpdef void settle_before(self, long long tick)
    cpdef void settle(self)
    cpdef bint held_by_us_alone(self)
    cdef bint _held_by_others(self)
    cdef void _know_parties(self)
    cdef void _condition(self, long long now, long long sda)
    cdef void _rises(self, long long now)
    cdef void _falls(self, long long now)
    cpdef void started(self, long long now)
    cpdef void stopped(self, long long now)
    cpdef void held(self, long long let_go, long long rose)
    cpdef void first_bit(self, long long let_go, long long rose)

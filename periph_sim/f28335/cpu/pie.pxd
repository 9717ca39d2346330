cimport cython

from ...core.chip cimport Chip


@cython.final
cdef class Pie(Chip):
    cdef public long long pulses
    cdef object _options
    cdef long long _piectrl, _pieack, _as_reset, _told_held
    cdef list _pieier, _pieifr, _lines_held, _set_at, _set_now, _seen
    cpdef void request(self, long long now, long long group, long long line)
    cpdef void hold(self, long long now, long long group, long long line, bint on)
    cpdef tuple vector(self, long long now, long long group)
    cpdef long long trap_vector(self, long long now, long long number)
    cpdef long long cpu_vector(self, long long now, long long number)
    cdef void _latch(self, long long now, long long g, long long bits)
    cdef void _send(self, long long g)
    cdef void _note_held(self, long long g)
    cdef void _acknowledge(self, long long now, long long value)
    cdef void _open(self, long long now, long long g)
    cdef bint _level_sensitive(self, long long g)
    cdef void _write_pieifr(self, long long now, long long g, long long value)
    cdef void _fetched(self, long long address)

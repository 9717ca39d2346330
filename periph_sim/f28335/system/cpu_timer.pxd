cimport cython

from ...core.chip cimport Chip


@cython.final
cdef class CpuTimer(Chip):
    cdef public long long base
    cdef object _options
    cdef bint _on_reload, _clocked
    cdef long long _tcr, _prd, _tddr, _since, _tim, _psc, _event_at
    cpdef void gate(self, long long now, bint on)
    cdef void _write_tcr(self, long long value)
    cdef bint _running(self)
    cdef void _sync(self, long long now)
    cdef void _schedule(self)

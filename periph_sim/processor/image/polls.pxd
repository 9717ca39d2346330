cimport cython

from ...f28335.cpu.interrupts cimport CpuInterrupts
from ..cpu_time cimport CpuTime
from ..operand cimport Operand
from ..polling cimport Lease, Spin


@cython.final
cdef class Polls:
    cdef public bint asleep, clean, counting, replaying, restarts, skips, tracking
    cdef public long long live_from, routines
    cdef public list elsewhere
    cdef public dict changed
    cdef dict _failed
    cdef list _values
    cdef bint _compared
    cdef CpuInterrupts _core
    cdef CpuTime _time
    cdef Lease _lease
    cdef Spin _spin
    cdef long long _branch, _look_at, _most, _next, _outer_branch, _outer_since, _passes, _period, _since, _started, _step
    cpdef void forget(self)
    cpdef bint again(self, long long branch, long long cycle)
    @cython.locals(cycle=cython.longlong, period=cython.longlong, equal=cython.bint, seen=cython.bint)
    cpdef bint comes_out_alike(self, bint as_before)
    cpdef bint may_be_alike(self)
    cpdef void look_later(self)
    @cython.locals(cycle=cython.longlong)
    cpdef bint may_count(self)
    @cython.locals(cycle=cython.longlong, alike=cython.bint)
    cpdef bint counted(self)
    cpdef void fails(self)
    cpdef void changes(self, long long address, long long before)
    cdef void _begin(self)
    cpdef void note(self, Operand operand, long long value)
    cpdef void note_elsewhere(self, long long address, long long value)
    cpdef void restart(self)
    cpdef void soil(self)
    @cython.locals(time=CpuTime, lease=Lease, spin=Spin, until=cython.longlong)
    cpdef Spin sleep(self, long long most=?)
    @cython.locals(time=CpuTime, passes=cython.longlong)
    cpdef long long woken(self, long long now)
    cpdef long long begins_at(self, long long passes)
    cpdef void resume(self, long long cycle)
    cpdef bint answer(self, long long cycle)
    cpdef long long answered(self)

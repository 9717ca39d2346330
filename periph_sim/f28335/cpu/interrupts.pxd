cdef class CpuInterrupts:
    cdef public long long entry_cycles, vector_delay, vector_waits, next_wake, ifr, ier, dbgier, st1, sp, nested, ready
    cdef public bint owes_instruction
    cdef public list notes
    cdef public set touched
    cdef object _options, _coming
    cdef long long _latched_at, _latched, _nonmaskable, _pieack_end, _returned_at
    cpdef void raise_line(self, long long now, long long number)
    cpdef void wrote_pieack(self, long long now)
    cpdef void wake(self, long long now)
    cpdef void reset(self, long long now)
    cpdef long long next_taken(self, long long now)
    cpdef long long earliest(self)
    cpdef object enter(self, long long now, long long number)
    cpdef object trap(self, long long now, long long number)
    cpdef object intr(self, long long now, long long number)
    cpdef void iret(self, long long now, long long st1, long long ier)
    cpdef void instruction_done(self)
    cpdef void clrc_intm(self, long long now)
    cpdef void setc_intm(self, long long now)
    cpdef void set_eallow(self, long long now, bint on)
    cpdef void and_ifr(self, long long now, long long mask)
    cpdef void or_ifr(self, long long now, long long mask)
    cpdef void and_ier(self, long long now, long long mask)
    cpdef void or_ier(self, long long now, long long mask)
    cpdef void mov_ier(self, long long now, long long value)
    cpdef void idle(self, long long now)
    cpdef bint idle_ends(self, long long now)
    cdef void _sync(self, long long now)
    cpdef object _save(self, long long number, long long first_instruction)
    cdef void _next_boundary(self, long long cycle)

cdef class Groups:
    cdef public long long nth
    cdef public bint inside
    cdef object _group, _begins_round
    cdef long long _seen, _frame_began, _frame_ended
    cpdef bint begins(self, long long tick, bint begin, bint end)
    cdef bint _is_first(self, long long now)
    cpdef bint is_nth(self)

cimport cython

from ..bus.i2c.transfer cimport Phase, Transfer


cdef class BusRounds:
    cdef public list on_transfer, on_round, on_due, on_missed, on_other
    cdef public long long completed, missed
    cdef object _begun_at, _schedule, _round
    cdef list _startup
    cdef tuple _requests
    cdef long long _late, _made, _number, _over
    cdef bint _ack_polling
    @cython.locals(first=Phase, place=cython.Py_ssize_t)
    cdef void _over_with(self, Transfer transfer)
    cdef void _tell(self, Transfer transfer)
    @cython.locals(made=Transfer, phase=Phase, start=cython.longlong)
    cdef void _request(self, Transfer transfer, Py_ssize_t place)
    cdef void _tell_incomplete(self, long long start)


@cython.locals(phases=list, phase=Phase, asked=Phase, place=cython.Py_ssize_t)
cpdef Transfer asked_for(Transfer transfer, Transfer request)
@cython.locals(asked=Phase)
cpdef bint may_be(Phase made, Transfer request)

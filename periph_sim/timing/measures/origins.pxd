cimport cython

from ...devices.model_codes cimport ModelCodes, Shown


@cython.final
cdef class Sent:
    cdef public long long number, ended
    cdef public tuple values
    cdef dict _shown
    cpdef bytes shown_at(self, long long address)


@cython.final
cdef class Chain:
    cdef public Sent sent
    cdef public long long before
    cdef public Shown shown


@cython.final
cdef class Run:
    cdef public long long number
    cdef public list sent


cdef class Origins:
    cdef public object _sent
    cdef public dict _of
    cpdef object of(self, object phase)
    cpdef object origin(self, long long address, bytes got)


cdef class FrameOrigins(Origins):
    cdef object _frames
    cdef dict _shown
    @cython.locals(sent=Sent, wanted=bytes, youngest_first=list)
    cpdef object origin(self, long long address, bytes got)


cdef class ModelOrigins(Origins):
    cdef ModelCodes _codes
    cdef bint _pulled_up, _left_out
    cdef list _chains, _before, _over, _may_take
    cdef long long _runs
    cdef Run _last
    @cython.locals(run=Run)
    cpdef object origin(self, long long address, bytes got)
    @cython.locals(chain=Chain, count=cython.longlong, many=cython.bint, may_be=list, sent=Sent)
    cdef list _longer(self, Run run)
    @cython.locals(least=cython.longlong, oldest=cython.longlong, may_be=list, sent=Sent)
    cdef list _may_be(self, Chain chain, Run run)
    cdef Chain _chain(self, long long number, Sent sent, Chain before)


@cython.locals(chain=Chain, fitting=list)
cdef list _fitting(object chains, long long address, bytes got)
@cython.locals(found=Sent, sent=Sent, wanted=bytes, best=bytes, agreeing=cython.longlong, agree=cython.longlong)
cdef object _nearest(bytes got, object candidates)

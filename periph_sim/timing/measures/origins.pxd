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
    @cython.locals(sent=Sent, wanted=bytes, youngest_first=list)
    cpdef object origin(self, long long address, bytes got)


cdef class ModelOrigins(Origins):
    cdef ModelCodes _codes
    cdef bint _pulled_up
    cdef list _chains, _before, _over, _may_take
    cdef long long _runs
    cdef Run _last
    @cython.locals(run=Run)
    cpdef object origin(self, long long address, bytes got)
    @cython.locals(chain=Chain, least=cython.longlong, sent=Sent)
    cdef list _longer(self, Run run)
    cdef Chain _chain(self, long long number, Sent sent, Shown before)


@cython.locals(chain=Chain, fitting=list)
cdef list _fitting(object chains, long long address, bytes got)
@cython.locals(found=Sent, sent=Sent, wanted=bytes, best=bytes, agreeing=cython.longlong, agree=cython.longlong)
cdef object _nearest(bytes got, object candidates)

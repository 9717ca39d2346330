cimport cython

from ..bus.uart.whole_frames cimport FrameParty, FrameSender, WholeFrames
from ..core.kernel cimport Kernel
from ..core.socket cimport Release, Socket
from ..core.time cimport Clock
from ..core.wire cimport Pin
from ..f28335.sci.module cimport Sci
from .pin_router cimport Router


@cython.final
cdef class SciHears(FrameParty):
    cdef Sci _chip
    cdef Clock _clock
    cdef Socket _socket


@cython.final
cdef class PadsHear(FrameParty):
    cdef Router _router
    cdef object _pads
    cdef long long _level, _tick


cdef class SciSends(FrameSender):
    cdef Sci _chip
    cdef Clock _clock
    cdef list _cycles
    cdef WholeFrames _frames
    cdef Kernel _kernel
    cdef object _lines
    cdef Socket _socket
    @cython.locals(chip=Sci, clock=Clock, pins=list, pin=Pin, frames=WholeFrames, now=cython.longlong, delay=cython.longlong, last=cython.longlong, coming=list, cycles=list)
    cpdef void begins(self)
    @cython.locals(frames=WholeFrames)
    cpdef void ends(self)
    @cython.locals(made=cython.longlong, now=cython.longlong, socket=Socket, kernel=Kernel, clock=Clock)
    cpdef void take_back(self, list edges)


@cython.final
cdef class SciPin(Release):
    cdef SciSends _sends

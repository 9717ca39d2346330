cimport cython

from ..bus.i2c.bit_times cimport CycleTimes
from ..bus.i2c.edge_play cimport EdgePlay
from ..bus.i2c.whole_bytes cimport ByteParty, WholeBytes
from ..core.records cimport Recorder
from ..core.socket cimport Release, Socket
from ..core.time cimport Clock
from ..f28335.i2c.master cimport I2cMaster
from ..f28335.i2c.module cimport I2c


@cython.final
cdef class MasterPlay(EdgePlay):
    cdef Socket _socket
    cdef Clock _clock
    cdef long long _cycle
    cpdef void begin_in_cycles(self, long long byte, long long release, long long low, long long high, long long hold)
    cdef void _next_at(self, long long cycle, long long tag)


cdef class I2cMasterBytes(Release):
    cdef Socket _socket
    cdef I2c _chip
    cdef I2cMaster _master
    cdef Clock _clock
    cdef ByteParty _party
    cdef WholeBytes _whole_bytes
    cdef CycleTimes _times
    cdef MasterPlay _play
    cdef public bint asks
    cdef long long _release, _low, _high, _under, _in, _sampled, _low_from, _rose_at
    @cython.locals(master=I2cMaster, whole_bytes=WholeBytes)
    cpdef bint holds_back(self)
    @cython.locals(master=I2cMaster, chip=I2c, phase=cython.longlong)
    cdef bint _plain(self)
    @cython.locals(master=I2cMaster, chip=I2c, times=CycleTimes, delay=cython.longlong, late=cython.longlong, release=cython.longlong, fell=cython.longlong, ends=cython.longlong, passes=cython.bint)
    cdef bint _passes(self, WholeBytes whole_bytes)
    cpdef long long byte(self)
    cpdef bint goes_on(self, long long shown)
    cpdef long long follow_at(self, long long fall)
    @cython.locals(master=I2cMaster, chip=I2c, period=cython.longlong)
    cpdef void stand(self, long long shown, long long bit)
    @cython.locals(recorder=Recorder, outer=cython.longlong)
    cpdef void again(self)

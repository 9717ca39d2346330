cimport cython

from ..bus.i2c.edge_play cimport SdaFollows
from ..bus.i2c.whole_bytes cimport ByteParty
from ..core.socket cimport Socket
from ..core.time cimport Clock
from ..core.wire cimport Pin
from ..f28335.i2c.module cimport I2c
from ..f28335.i2c.noise_filter cimport I2cNoiseFilter
from ..f28335.i2c.registers cimport I2cRegisters
from ..f28335.i2c.slave cimport I2cSlave
from .i2c_master_bytes cimport I2cMasterBytes


@cython.final
cdef class I2cSlaveEdges(SdaFollows):
    cdef Socket _socket
    cdef I2c _chip
    cdef Clock _clock
    cdef long long _cycle


cdef class I2cSlaveBytes(ByteParty):
    cdef I2cSlaveEdges _mover
    cdef public I2cMasterBytes master
    cdef Socket _socket
    cdef I2c _chip
    cdef Clock _clock
    cdef I2cSlave _target
    cdef bint _calm, _exact
    cdef long long _calm_for
    cdef object _hz
    @cython.locals(pin=Pin, mask=cython.longlong)
    cpdef long long pulls(self, long long line)
    cpdef void act(self, long long tag)
    cpdef long long byte(self)
    cpdef bint goes_on(self, long long shown)
    cpdef long long follow_at(self, long long fall)
    cpdef bint apart(self, long long fall, long long moved)
    @cython.locals(chip=I2c, target=I2cSlave, lines=I2cNoiseFilter, state=I2cRegisters, wanted=cython.longlong)
    cpdef bint ready(self, long long low, long long high, long long hold, bint each)
    cdef bint _is_calm(self, long long low, long long high, long long hold, bint each)
    cdef long long _cycles(self, long long ticks)
    @cython.locals(chip=I2c, target=I2cSlave, levels=cython.longlong)
    cpdef void stand(self, long long shown, long long bit, long long fell)
    cpdef SdaFollows meanwhile(self)
    cpdef void edge(self, long long tick, long long levels)
    cpdef bint pulls_sda(self)
    cpdef bint holds(self)

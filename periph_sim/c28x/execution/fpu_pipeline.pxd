cimport cython

from .registers cimport Cpu, Operation

cpdef void delay(Operation f)
@cython.locals(late=cython.longlong, due=cython.longlong, flags=cython.longlong, raised=cython.longlong,
               number=cython.longlong, value=cython.longlong)
cdef void delayed(Cpu cpu, Operation f)
@cython.locals(number=cython.longlong)
cpdef void arrive(Cpu cpu)

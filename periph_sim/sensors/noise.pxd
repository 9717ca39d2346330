cimport cython


cdef class Gaussian:
    cdef public object key
    cdef object _block, _kept
    @cython.locals(block=cython.longlong, place=cython.Py_ssize_t)
    cpdef object at(self, long long number)
    cpdef object near(self, long long number)


cdef class AxisNoise:
    cdef public list _octaves
    cdef public object _step
    cdef object _white_sigma, _octave_sigma, _walked
    cdef Gaussian _white, _walk
    @cython.locals(octave=Gaussian)
    cpdef object at(self, long long number)
    cpdef object near(self, long long number)


cdef class SensorNoise:
    cdef list _axes
    @cython.locals(x=AxisNoise, y=AxisNoise, z=AxisNoise)
    cpdef tuple at(self, long long number)
    @cython.locals(axis=AxisNoise)
    cpdef object near(self, long long number)

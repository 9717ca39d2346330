from .registers cimport Operation

cpdef Operation operation(object instruction)
cpdef Operation form_of(object encoding)
cdef Operation _form_of(object encoding)
cpdef void bind(Operation f, str name)

cimport cython


@cython.final
cdef class SciFormat:
    cdef public long long sciccr, data_bits, data_mask, stops, extra_bits, stop_bit, bits, stop_at, vote_at, voted_at, due, end
    cdef public long long hunt, break_at
    cdef public bint address, parity, even, early_hunt
    cpdef long long parity_bit(self, long long word, long long address)
    cpdef long long levels(self, long long word, long long address, bint whole_byte)

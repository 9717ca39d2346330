ctypedef bint (*Execute)(Cpu, Operation) except -1


cdef class Operation:
    cdef public long long b, c, g, h, i, k, l, m, n, p, q, r, s, t, u, v, w, x, y, z
    cdef public long long place, absolute, accesses, address, cycles, late, makes, needs, next, not_taken, repeated
    cdef public long long tested, block, block_end
    cdef public bint at_once, byte, jumps, loops, waited, wide
    cdef public object encoding
    cdef public Operation following, goal
    cdef Execute execute, plain


cdef class Cpu:
    cdef public long long acc, p, xt, dp, rpc, arp, sp, pc, sxm, ovm, tc, c, z, n, v, pm, ovc
    cdef public long long st1, ier, ifr, dbgier, dbgstat, stf, shadow_stf, rb, ea, field, cycles, written_in, repeat, passes, due, due_flags
    cdef public long long xar[8]
    cdef public long long r[8]
    cdef public long long shadow_r[8]
    cdef long long before_r[8]
    cdef long long due_r[8]
    cdef public bint high_byte
    cpdef long long load16(self, long long address)
    cpdef void store16(self, long long address, long long value)
    cpdef long long load32(self, long long address)
    cpdef void store32(self, long long address, long long value)
    cpdef long long program16(self, long long address)
    cpdef long long st0(self)
    cpdef void put_st0(self, long long value)
    cpdef long long whole_st1(self)
    cpdef void put_st1(self, long long value)
    cpdef void change_st1(self, long long mask, bint on)
    cpdef long long whole_ier(self)
    cpdef void put_ier(self, long long value)
    cpdef long long whole_ifr(self)
    cpdef void put_ifr(self, long long value)
    cpdef void and_ifr(self, long long mask)
    cdef void put_ovc(self, long long value)
    cdef void nz16(self, long long value)
    cdef void nz32(self, long long value)
    cdef bint condition(self, long long code)
    cdef long long ax(self, long long x)
    cdef void put_ax(self, long long x, long long value)
    cpdef long long t(self)
    cpdef void put_t(self, long long value)
    cdef void put_ar(self, long long n, long long value)
    cpdef long long acc_p(self)
    cdef void put_acc_p(self, long long value)
    cdef long long x16(self, long long value)
    cdef long long psh(self)
    cdef void locate(self, Operation f)
    cdef void _at_xar(self, long long n, long long offset, bint byte)
    cdef void _by_xar(self, long long n, long long mode, long long step, bint byte)
    cdef void _by_arp(self, long long field, long long step)
    cdef long long read16(self)
    cdef void write16(self, long long value)
    cdef long long read32(self)
    cdef void write32(self, long long value)
    cdef long long beside(self, long long words)
    cdef void move16(self, long long value)
    cdef void move32(self, long long value)
    cpdef void enter(self, long long vector)
    cpdef bint intr_clears_flag(self, long long bit)
    cpdef void leave(self)
    cpdef void idle(self)
    cpdef void stop(self)
    cdef void push16(self, long long value)
    cdef long long pop16(self)
    cdef void push32(self, long long value)
    cdef long long pop32(self)
    cdef void push_pair(self, long long low, long long high)
    cdef long long pop_pair(self)


cdef long long s16(long long value) noexcept
cdef long long s32(long long value) noexcept
cdef long long reversed_carry(long long low, long long index, bint subtract) noexcept
cdef long long mirrored(long long value) noexcept

/* Replaces the C28x for C sources that run on the host: asks Python to make each access of firmware to a register.
 *
 * gcc's thread sanitizer calls a function of this file before each access. Before a read, Python stores the value of
 * the register in memory. The call before a write only announces the bytes, so the written value is passed to Python
 * at the next call of this file. Structures of registers are in memory as the host's gcc lays them out; Python knows
 * the address of each member on the chip.
 *
 * gcc announces a write of a bit field as a write of all adjacent fields. If these belong to several words, or overlap
 * a number, the memory is protected until the store, and the handler of the fault determines what is written. It
 * executes the load before the store with zeros in memory, and again with ones; the bits that are equal in both stores
 * are those of the field. Then it executes load and store with the real values. */

#define _GNU_SOURCE /* REG_RIP */
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <ucontext.h>
#include <unistd.h>

enum { READ, ANNOUNCED, WRITE, TOUCHED, TIME, ASSEMBLY, DELAY, ENDS };
enum { ENDED, UNWOUND, FAULT, LOOPS };

#define BYTES 0x40000u /* of register memory: four for each word of the chip */
#define STACK_BYTES 0x100000 /* limit of the stack; more than any memory of the chip */
#define LARGEST 8      /* maximum number of bytes of an access */
#define BLOCK_CYCLES 6 /* as in firmware.py */
#define LOGGED_COMPUTE UINT64_C(1) /* kinds of log items, as in access_log.py */
#define LOGGED_READ UINT64_C(2)
#define STRANGE 9      /* result of `stored` for an instruction that is no MOV */
#define STUB_PAGE 0x380000u /* host page with a return instruction, since firmware may call ADC_cal by its address */
#define PAGE 4096u
#define TICK_US 20000 /* microseconds of processor time between two checks for an endless empty loop */
#define QUIET_TICKS 3

/* Handles a request in Python. Returns UNWINDS if Python has raised an exception. Otherwise returns, for ANNOUNCED and
 * TOUCHED, the number of the place that is written, or PROTECTED if only the store determines it; else NO_PLACE. */
typedef int (*asked_t)(int what, uint32_t at, uint32_t size, uint64_t detail, uint64_t blocks, uint64_t pc);
enum { UNWINDS = -1, NO_PLACE, PROTECTED };

static asked_t asked;
static unsigned char *registers;
static uint64_t blocks, blocks_at_once = UINT64_MAX; /* constructors run before c28x_begin sets a limit */
static uint64_t times_asked;
static int pending; /* number of the place whose written value is not passed yet; NO_PLACE if there is none */
static uint64_t pending_pc;
static uint32_t protected_at, protected_size; /* announced bytes; size 0 if nothing is protected */
static enum { BEGINS, ZEROS, ONES } phase;    /* of the search for the bits that the store writes there */
static sigjmp_buf *way_out; /* where the firmware that runs now is left; NULL while Python runs */
static pthread_t runner;    /* the thread that runs this firmware: way_out is on its stack */
static const int SIGNALS[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL};
#define SIGNAL_COUNT (sizeof SIGNALS / sizeof *SIGNALS)
static struct sigaction before[SIGNAL_COUNT];
static long page_size;
static const char *stack; /* stack pointer when the firmware began */

int c28x_signal;
uint64_t c28x_fault_at, c28x_fault_pc;
int c28x_numbers[BYTES][LARGEST + 1]; /* by offset and size of an announced write: its place, if Python has stored it */

/* Handles a timer signal. In `for (;;);` gcc inserts no call of this file, so this handler leaves the loop. Python then
 * lets time pass, in which service routines can run. */
static void ticked(int number) {
    static uint64_t seen_blocks, seen_asked;
    static int quiet;
    if (!way_out) return;
    if (!pthread_equal(pthread_self(), runner)) { /* the timer of a process signals any of its threads */
        pthread_kill(runner, number);
        return;
    }
    quiet = blocks == seen_blocks && times_asked == seen_asked ? quiet + 1 : 0;
    seen_blocks = blocks;
    seen_asked = times_asked;
    if (quiet >= QUIET_TICKS) {
        quiet = 0;
        siglongjmp(*way_out, LOOPS);
    }
}

/* Installs the handler of the timer signal, which stays installed, and does nothing while Python runs. */
static void catch_ticks(void) {
    struct sigaction mine;
    memset(&mine, 0, sizeof mine);
    mine.sa_handler = ticked;
    mine.sa_flags = SA_RESTART | SA_NODEFER;
    sigaction(SIGVTALRM, &mine, NULL);
}

static void caught(int number, siginfo_t *info, void *context);

static void catch_signals(void) {
    struct sigaction mine;
    memset(&mine, 0, sizeof mine);
    mine.sa_sigaction = caught;
    mine.sa_flags = SA_SIGINFO | SA_NODEFER;
    for (size_t i = 0; i < SIGNAL_COUNT; i++) sigaction(SIGNALS[i], &mine, &before[i]);
    catch_ticks();
}

static void leave_signals(void) {
    for (size_t i = 0; i < SIGNAL_COUNT; i++) sigaction(SIGNALS[i], &before[i], NULL);
}

/* The log of an earlier run, which this run executes again up to its end, and the index of the next item (see
 * access_log.py). */
const uint64_t *c28x_log;
uint64_t c28x_log_next, c28x_log_end;

/* Answers a request from the log, without Python. Returns 1 if it has, and 0 if Python must handle the request. The log
 * answers requests to let time pass, and reads of one member, if they equal the next items. */
static int is_answered(int what, uint32_t at, uint32_t size) {
    uint64_t next = c28x_log_next, item;
    int64_t value;
    if ((what != READ && what != TIME) || next + 2 > c28x_log_end) return 0;
    if (blocks && c28x_log[next++] != (LOGGED_COMPUTE << 61 | BLOCK_CYCLES * blocks)) return 0;
    if (what == READ) {
        item = c28x_log[next++];
        if (item >> 40 != (LOGGED_READ << 21 | (uint64_t)(size & 7) << 18 | at) || size > LARGEST) return 0;
        value = (int64_t)(item << 24) >> 24;
        memcpy(registers + at, &value, size);
    }
    c28x_log_next = next;
    blocks = 0;
    times_asked++;
    return 1;
}

static int ask(int what, uint32_t at, uint32_t size, uint64_t detail, uint64_t pc) {
    if (c28x_log_next < c28x_log_end && is_answered(what, at, size)) return NO_PLACE;
    sigjmp_buf *mine = way_out;
    uint64_t passed = blocks;
    blocks = 0;
    times_asked++;
    way_out = NULL;
    leave_signals();
    int said = asked(what, at, size, detail, passed, pc);
    catch_signals();
    way_out = mine;
    if (said == UNWINDS) siglongjmp(*mine, UNWOUND);
    return said;
}

static void protect(int how) {
    uintptr_t first = ((uintptr_t)registers + protected_at) & ~(uintptr_t)(page_size - 1);
    mprotect((void *)first, (uintptr_t)registers + protected_at + protected_size - first, how);
}

static void unprotect(void) {
    if (protected_size) protect(PROT_READ | PROT_WRITE);
    protected_size = 0;
}

static void tell_pending(void) {
    int place = pending;
    pending = NO_PLACE;
    unprotect();
    if (place) ask(WRITE, 0, 0, (uint64_t)place, pending_pc);
}

static int register_offset(const void *address, uint32_t *at) {
    uintptr_t offset = (uintptr_t)address - (uintptr_t)registers;
    *at = (uint32_t)offset;
    return offset < BYTES;
}

/* Returns the number of bytes that an instruction stores that has faulted; 0 for a load, STRANGE if it is no MOV. Sets
 * *value to the value that a MOV from a register stores. */
static uint32_t stored(const ucontext_t *context, uint64_t *value) {
#if defined(__x86_64__)
    static const int REGISTERS[] = {REG_RAX, REG_RCX, REG_RDX, REG_RBX, REG_RSP, REG_RBP, REG_RSI, REG_RDI,
                                    REG_R8, REG_R9, REG_R10, REG_R11, REG_R12, REG_R13, REG_R14, REG_R15};
    const greg_t *held = context->uc_mcontext.gregs;
    const unsigned char *code = (const unsigned char *)held[REG_RIP];
    uint32_t size = 4, rex = 0;
    if (!(held[REG_ERR] & 2)) return 0;
    if (*code == 0x66) size = 2, code++;
    if ((*code & 0xF0) == 0x40) rex = *code++;
    if (rex & 8) size = 8;
    *value = (uint64_t)held[REGISTERS[(code[1] >> 3 & 7) + (rex & 4 ? 8 : 0)]]; /* source of MOV */
    if (*code == 0x88 || *code == 0xC6) return 1;
    return *code == 0x89 || *code == 0xC7 ? size : STRANGE;
#else
    (void)context, (void)value;
    return 0; /* RegisterLayout rejects sources that need this function on other hosts */
#endif
}

static void find_field(unsigned char with) {
    protect(PROT_READ | PROT_WRITE);
    memset(registers + protected_at, with, protected_size);
    protect(PROT_READ);
}

/* Handles a fault of a load or store in the protected bytes. */
static void touched(uint32_t at, ucontext_t *context) {
    static ucontext_t at_load;
    static uint64_t with_zeros;
    uint64_t value = 0, announced = (uint64_t)protected_at << 8 | protected_size, kept;
    uint32_t size = stored(context, &value);
    switch (size == STRANGE ? BEGINS : phase) {
    case BEGINS:
        if (size) break;
        memcpy(at_load.uc_mcontext.gregs, context->uc_mcontext.gregs, sizeof at_load.uc_mcontext.gregs);
        find_field(0);
        phase = ZEROS;
        return;
    case ZEROS:
        with_zeros = value;
        memcpy(context->uc_mcontext.gregs, at_load.uc_mcontext.gregs, sizeof at_load.uc_mcontext.gregs);
        find_field(0xFF);
        phase = ONES;
        return;
    case ONES:
        memcpy(context->uc_mcontext.gregs, at_load.uc_mcontext.gregs, sizeof at_load.uc_mcontext.gregs);
        kept = value ^ with_zeros;
        while (size && (kept & 0xFF) == 0xFF) kept >>= 8, size--, at++;
        size = 0;
    }
    unprotect();
    pending = ask(TOUCHED, at, size, announced, pending_pc);
}

static void caught(int number, siginfo_t *info, void *context) {
    uint32_t at;
    if (!way_out || !pthread_equal(pthread_self(), runner)) { /* firmware has not caused it */
        signal(number, SIG_DFL);
        return;
    }
    if (protected_size && number == SIGSEGV && register_offset(info->si_addr, &at)) {
        touched(at, (ucontext_t *)context);
        return;
    }
    c28x_signal = number;
    c28x_fault_at = (uint64_t)(uintptr_t)info->si_addr;
#if defined(__x86_64__)
    c28x_fault_pc = (uint64_t)((ucontext_t *)context)->uc_mcontext.gregs[REG_RIP];
#elif defined(__aarch64__)
    c28x_fault_pc = ((ucontext_t *)context)->uc_mcontext.pc;
#endif
    siglongjmp(*way_out, FAULT);
}

static void reads(const void *address, uint32_t size, int is_volatile, void *pc) {
    uint32_t at;
    if (register_offset(address, &at)) {
        tell_pending();
        ask(READ, at, size, 0, (uint64_t)(uintptr_t)pc);
    } else if (is_volatile) { /* the firmware may wait for a variable that a service routine writes */
        tell_pending();
        ask(TIME, 0, 0, 0, (uint64_t)(uintptr_t)pc);
    }
}

static void writes(const void *address, uint32_t size, void *pc) {
    uint32_t at;
    int place;
    if (!register_offset(address, &at)) return;
    tell_pending();
    place = size <= LARGEST ? c28x_numbers[at][size] : NO_PLACE;
    if (!place) place = ask(ANNOUNCED, at, size, 0, (uint64_t)(uintptr_t)pc);
    pending_pc = (uint64_t)(uintptr_t)pc;
    if (place == PROTECTED) {
        protected_at = at, protected_size = size, phase = BEGINS;
        protect(PROT_NONE);
    } else {
        pending = place;
    }
}

#define PC __builtin_return_address(0)
#define HOOKS(size) \
    void __tsan_read##size(void *a) { reads(a, size, 0, PC); } \
    void __tsan_write##size(void *a) { writes(a, size, PC); } \
    void __tsan_volatile_read##size(void *a) { reads(a, size, 1, PC); } \
    void __tsan_volatile_write##size(void *a) { writes(a, size, PC); } \
    void __tsan_unaligned_read##size(void *a) { reads(a, size, 0, PC); } \
    void __tsan_unaligned_write##size(void *a) { writes(a, size, PC); } \
    void __tsan_unaligned_volatile_read##size(void *a) { reads(a, size, 1, PC); } \
    void __tsan_unaligned_volatile_write##size(void *a) { writes(a, size, PC); }
HOOKS(1)
HOOKS(2)
HOOKS(4)
HOOKS(8)
HOOKS(16)
void __tsan_read_range(void *a, unsigned long size) { reads(a, (uint32_t)size, 0, PC); }
void __tsan_write_range(void *a, unsigned long size) { writes(a, (uint32_t)size, PC); }
void __tsan_init(void) {}
/* Functions of the C library that would end the process of the simulator: library.py makes the linker replace them. */
static void ends(const char *how, void *pc) {
    tell_pending();
    ask(ENDS, 0, 0, (uint64_t)(uintptr_t)how, (uint64_t)(uintptr_t)pc - 1); /* - 1, since no code follows the call */
}

#define ENDING(name) \
    void __wrap_##name(int status) { \
        char text[40]; \
        snprintf(text, sizeof text, #name "(%d) is called", status); \
        ends(text, PC); \
    }
ENDING(exit)
ENDING(_exit)
ENDING(_Exit)
ENDING(quick_exit)
void __wrap_abort(void) { ends("abort() is called", PC); }
void __wrap___assert_fail(const char *assertion) {
    char text[200];
    snprintf(text, sizeof text, "assert(%s) fails", assertion);
    ends(text, PC);
}

void __tsan_func_entry(void *pc) {
    const char *here = __builtin_frame_address(0);
    if (stack && stack - here > STACK_BYTES) ends("the stack has more than 1 MB", pc);
}
void __tsan_func_exit(void) { tell_pending(); }

/* gcc inserts a call of this function at the start of each basic block, so that loops without accesses take time. */
void __sanitizer_cov_trace_pc(void) {
    tell_pending();
    if (++blocks >= blocks_at_once) ask(TIME, 0, 0, 0, (uint64_t)(uintptr_t)PC);
}

void c28x_assembly(const char *text) {
    tell_pending();
    ask(ASSEMBLY, 0, 0, (uint64_t)(uintptr_t)text, (uint64_t)(uintptr_t)PC);
}

/* The macro DELAY_US of TI's headers calls this function. A pass of its loop takes 5 cycles. */
__attribute__((weak)) void DSP28x_usDelay(unsigned long passes) {
    tell_pending();
    ask(DELAY, 0, 0, passes, (uint64_t)(uintptr_t)PC);
}

/* On the chip, this function sets trims of the ADC, which are not modelled. */
__attribute__((weak)) void ADC_cal(void) {}

/* Words of flash and OTP: the passwords of an erased chip, and the number of the part. */
__attribute__((weak)) unsigned CsmPwl[8] = {0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF};
__attribute__((weak)) unsigned PartIdRegs[1] = {0x00EF};

/* Maps register memory at `base`. Returns 0, or 1 if this address is not free. */
int c28x_begin(uint64_t base, asked_t who, uint64_t at_once) {
    void *page = (void *)(uintptr_t)STUB_PAGE;
    const struct itimerval tick = {{0, TICK_US}, {0, TICK_US}};
    asked = who;
    blocks_at_once = at_once;
    page_size = sysconf(_SC_PAGESIZE);
    catch_ticks(); /* before the timer starts, because a signal without a handler ends the process */
    setitimer(ITIMER_VIRTUAL, &tick, NULL);
    registers = mmap((void *)(uintptr_t)base, BYTES, PROT_READ | PROT_WRITE,
                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1, 0);
    if (registers != (void *)(uintptr_t)base) return 1;
    page = mmap(page, PAGE, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1, 0);
    if (page == (void *)(uintptr_t)STUB_PAGE) { /* otherwise another unit has mapped the page */
        memset(page, 0xC3, PAGE); /* RET */
        mprotect(page, PAGE, PROT_READ | PROT_EXEC);
    }
    return 0;
}

/* last: 1 if no other program runs in this process. */
void c28x_end(int last) {
    const struct itimerval none = {{0, 0}, {0, 0}};
    if (last) setitimer(ITIMER_VIRTUAL, &none, NULL);
    munmap(registers, BYTES);
}

/* Calls a function of the firmware: main or a service routine. Returns how it ended. */
int c28x_run(void (*entry)(void)) {
    sigjmp_buf here, *outer = way_out;
    int place = pending; /* of the code that the function interrupts */
    uint64_t pc = pending_pc;
    pending = NO_PLACE;
    runner = pthread_self();
    catch_signals();
    int how = sigsetjmp(here, 1);
    if (!outer) stack = __builtin_frame_address(0);
    if (!how) {
        way_out = &here;
        entry();
        tell_pending();
        if (blocks) ask(TIME, 0, 0, 0, (uint64_t)(uintptr_t)entry);
    } else if (how == LOOPS) {
        way_out = &here;
        tell_pending();
    }
    way_out = outer;
    leave_signals();
    unprotect();
    pending = place, pending_pc = pc;
    return how;
}

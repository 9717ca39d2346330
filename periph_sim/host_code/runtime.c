/* What C sources find below them in place of a C28x: accesses that gcc's thread sanitizer announces go in, the
 * host's Python is asked, and what a register holds stands in memory before it is read.
 *
 * A word of the chip's address space is four bytes here, as `unsigned int` is, so the structures of register headers
 * lie as on the chip. A write is announced before it is made: it is told with the next thing that happens. */

#define _GNU_SOURCE /* REG_RIP */
#include <setjmp.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <ucontext.h>

enum { READ, WRITE, TIME, ASSEMBLY, DELAY, HALF_WORD };
enum { ENDED, UNWOUND, FAULT, LOOPS };

#define WORDS 0x10000u
#define STUB_PAGE 0x380000u /* ADC_cal is called there, and returns at once */
#define PAGE 4096u
#define TICK_US 20000 /* of processor time: so often it is looked whether an empty loop runs */
#define QUIET_TICKS 3

typedef int (*asked_t)(int what, uint32_t word, uint32_t size, uint64_t detail, uint64_t blocks, uint64_t pc);

static asked_t asked;
static unsigned char *registers;
static uint64_t blocks, blocks_at_once = UINT64_MAX; /* constructors run before anybody asks */
static uint64_t times_asked;
static uint32_t pending_word, pending_size;
static uint64_t pending_pc;
static sigjmp_buf *way_out; /* of the firmware that runs now; none while Python runs */
static const int SIGNALS[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL};
#define SIGNAL_COUNT (sizeof SIGNALS / sizeof *SIGNALS)
static struct sigaction before[SIGNAL_COUNT];

int c28x_signal;
uint64_t c28x_fault_at, c28x_fault_pc;
unsigned char c28x_wide[WORDS]; /* not 0: a register of 32 bits begins there */

/* `for (;;);` has no piece of code that gcc would announce: nothing but a service routine can happen any more. */
static void ticked(int number) {
    static uint64_t seen_blocks, seen_asked;
    static int quiet;
    (void)number;
    if (!way_out) return;
    quiet = blocks == seen_blocks && times_asked == seen_asked ? quiet + 1 : 0;
    seen_blocks = blocks;
    seen_asked = times_asked;
    if (quiet >= QUIET_TICKS) {
        quiet = 0;
        siglongjmp(*way_out, LOOPS);
    }
}

static void caught(int number, siginfo_t *info, void *context) {
    if (!way_out) { /* not the firmware's: as if nobody were here */
        signal(number, SIG_DFL);
        return;
    }
    c28x_signal = number;
    c28x_fault_at = (uint64_t)(uintptr_t)info->si_addr;
#if defined(__x86_64__)
    c28x_fault_pc = (uint64_t)((ucontext_t *)context)->uc_mcontext.gregs[REG_RIP];
#elif defined(__aarch64__)
    c28x_fault_pc = ((ucontext_t *)context)->uc_mcontext.pc;
#else
    (void)context;
#endif
    siglongjmp(*way_out, FAULT);
}

/* It stays, and does nothing while Python runs. */
static void catch_ticks(void) {
    struct sigaction mine;
    memset(&mine, 0, sizeof mine);
    mine.sa_handler = ticked;
    mine.sa_flags = SA_RESTART | SA_NODEFER;
    sigaction(SIGVTALRM, &mine, NULL);
}

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

static void ask(int what, uint32_t word, uint32_t size, uint64_t detail, uint64_t pc) {
    sigjmp_buf *mine = way_out;
    uint64_t passed = blocks;
    blocks = 0;
    times_asked++;
    way_out = NULL;
    leave_signals();
    int unwinds = asked(what, word, size, detail, passed, pc);
    catch_signals();
    way_out = mine;
    if (unwinds) siglongjmp(*mine, UNWOUND);
}

static void tell_pending(void) {
    if (!pending_size) return;
    uint32_t size = pending_size;
    pending_size = 0;
    ask(WRITE, pending_word, size, 0, pending_pc);
}

static int register_word(const void *address, uint32_t *word) {
    uintptr_t offset = (uintptr_t)address - (uintptr_t)registers;
    *word = (uint32_t)(offset / 4);
    return offset < 4 * (uintptr_t)WORDS;
}

/* A bit field is accessed with its word: this is a uint16_t, with which structures do not lie as on the chip. */
static void refuse_half_words(const void *address, uint32_t size, void *pc) {
    uint32_t word;
    if ((uintptr_t)address % 4 && register_word(address, &word))
        ask(HALF_WORD, word, size, 0, (uint64_t)(uintptr_t)pc);
}

static void reads(const void *address, uint32_t size, int is_volatile, void *pc) {
    uint32_t word;
    if (register_word(address, &word)) {
        tell_pending();
        ask(READ, word, size, 0, (uint64_t)(uintptr_t)pc);
    } else if (is_volatile) { /* somebody waits for what a service routine writes */
        tell_pending();
        ask(TIME, 0, 0, 0, (uint64_t)(uintptr_t)pc);
    }
}

static void writes(const void *address, uint32_t size, void *pc) {
    uint32_t word;
    if (!register_word(address, &word)) return;
    tell_pending();
    if (size < 4 || (size == 4 && c28x_wide[word])) /* a bit field: the rest of its register is written with it */
        ask(READ, word, size, 0, (uint64_t)(uintptr_t)pc);
    pending_word = word;
    pending_size = size;
    pending_pc = (uint64_t)(uintptr_t)pc;
}

#define PC __builtin_return_address(0)
#define HOOKS(size) \
    void __tsan_read##size(void *a) { reads(a, size, 0, PC); } \
    void __tsan_write##size(void *a) { writes(a, size, PC); } \
    void __tsan_volatile_read##size(void *a) { refuse_half_words(a, size, PC); reads(a, size, 1, PC); } \
    void __tsan_volatile_write##size(void *a) { refuse_half_words(a, size, PC); writes(a, size, PC); } \
    void __tsan_unaligned_read##size(void *a) { reads(a, size, 0, PC); } \
    void __tsan_unaligned_write##size(void *a) { writes(a, size, PC); } \
    void __tsan_unaligned_volatile_read##size(void *a) { reads(a, size, 1, PC); } \
    void __tsan_unaligned_volatile_write##size(void *a) { writes(a, size, PC); }
HOOKS(1)
HOOKS(2)
HOOKS(4)
HOOKS(8)
HOOKS(16)
void __tsan_read_range(void *a, unsigned long size) { (void)a, (void)size; }
void __tsan_write_range(void *a, unsigned long size) { (void)a, (void)size; }
void __tsan_init(void) {}
void __tsan_func_entry(void *pc) { (void)pc; }
void __tsan_func_exit(void) { tell_pending(); }

/* Every piece of code without a branch in it begins so: loops without any access let time pass, too. */
void __sanitizer_cov_trace_pc(void) {
    tell_pending();
    if (++blocks >= blocks_at_once) ask(TIME, 0, 0, 0, (uint64_t)(uintptr_t)PC);
}

void c28x_assembly(const char *text) {
    tell_pending();
    ask(ASSEMBLY, 0, 0, (uint64_t)(uintptr_t)text, (uint64_t)(uintptr_t)PC);
}

/* DELAY_US of the headers calls it: 5 cycles a pass. */
__attribute__((weak)) void DSP28x_usDelay(unsigned long passes) {
    tell_pending();
    ask(DELAY, 0, 0, passes, (uint64_t)(uintptr_t)PC);
}

/* It sets trims of the ADC, which nothing models. */
__attribute__((weak)) void ADC_cal(void) {}

/* Words of OTP and flash: passwords of an erased chip, and which chip it is. */
__attribute__((weak)) unsigned CsmPwl[8] = {0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF};
__attribute__((weak)) unsigned PartIdRegs[1] = {0x00EF};

/* 0 if the registers have their place. */
int c28x_begin(uint64_t base, asked_t who, uint64_t at_once) {
    void *page = (void *)(uintptr_t)STUB_PAGE;
    const struct itimerval tick = {{0, TICK_US}, {0, TICK_US}};
    asked = who;
    blocks_at_once = at_once;
    catch_ticks(); /* first: a tick that nobody catches ends the process */
    setitimer(ITIMER_VIRTUAL, &tick, NULL);
    registers = mmap((void *)(uintptr_t)base, 4 * WORDS, PROT_READ | PROT_WRITE,
                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1, 0);
    if (registers != (void *)(uintptr_t)base) return 1;
    page = mmap(page, PAGE, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1, 0);
    if (page == (void *)(uintptr_t)STUB_PAGE) { /* else another unit has put it there */
        memset(page, 0xC3, PAGE); /* RET */
        mprotect(page, PAGE, PROT_READ | PROT_EXEC);
    }
    return 0;
}

/* last: no other program runs in this process. */
void c28x_end(int last) {
    const struct itimerval none = {{0, 0}, {0, 0}};
    if (last) setitimer(ITIMER_VIRTUAL, &none, NULL);
    munmap(registers, 4 * WORDS);
}

/* Calls a function of the firmware, main or a service routine. Says how it ended. */
int c28x_run(void (*entry)(void)) {
    sigjmp_buf here, *outer = way_out;
    uint32_t word = pending_word, size = pending_size; /* of what it interrupts */
    uint64_t pc = pending_pc;
    pending_size = 0;
    catch_signals();
    int how = sigsetjmp(here, 1);
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
    pending_word = word, pending_size = size, pending_pc = pc;
    return how;
}

"""Pipeline stalls of short programs, by SPRU430F 4.3 and 4.4 and TI's page on pipeline conflicts."""

from __future__ import annotations

import pytest

from periph_sim.core.options import Value
from periph_sim.processor.c28x.pipeline import BY_ARP, DEPTH, DP, SP, FetchQueue, addressing
from tests.processor.image.rig import HEAD, Rig, ended

L1, L4 = 0x9000, 0xC000
BEGIN = " MOVW DP,#0x9100 >> 6\n MOVL XAR4,#0x9100\n MOVL XAR5,#0x9140\n MOVL XAR7,#0x9180\n NOP\n NOP\n NOP\n"


def cycles(code: str, **options: Value) -> int:
    """Return the cycles from reset to ESTOP0."""
    return ended(HEAD + BEGIN + code + "\n ESTOP0\n", **options)


def stalls(code: str) -> int:
    return cycles(code) - cycles(code, stalls=False)


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        # a register is loaded in E and used for an address in D2
        ("MOVL XAR4,@0 | MOV AL,*XAR4", 3),
        ("MOVL XAR4,@0 | NOP | MOV AL,*XAR4", 2),
        ("MOVL XAR4,@0 | NOP | NOP | MOV AL,*XAR4", 1),
        ("MOVL XAR4,@0 | NOP | NOP | NOP | MOV AL,*XAR4", 0),
        ("MOVL XAR4,@0 | EALLOW | MOV AL,*XAR4", 0),  # 4 cycles
        ("MOVL XAR4,@0 | MOVL XAR5,@2 | MOV AL,*XAR4 | MOV AH,*XAR5", 2),  # the first stall also covers the second
        ("MOVL XAR4,@0 | MOV AL,*XAR5", 0),
        ("MOVL XAR4,#0x9100 | MOV AL,*XAR4", 0),  # written in D2
        ("MOVL XAR4,@0 | MOVL XAR4,#0x9100", 3),  # D2 after E: both write the register
        ("MOVL XAR4,@0 | MOV @2,AR4", 3),  # read in D2 as a source
        ("MOV @AR4,AL | MOV AH,*XAR4", 3),
        ("MOVZ AR0,@0 | MOV AL,*+XAR4[AR0]", 3),
        ("MOVZ AR0,@0 | MOV AL,*+XAR4[1]", 0),
        ("MOV DP,#0x244 | MOV AL,@0", 0),
        ("PUSH DP | POP DP | MOV AL,@0", 3 + 3),  # once for the stacked word, once for DP
        # the stack pointer: ADDB writes it in E
        ("ADDB SP,#2 | MOV *-SP[1],AL", 3),
        ("ADDB SP,#2 | SUBB SP,#2", 0),  # both in E
        ("MOVL XAR7,@0 | LCR *XAR7", 3),
        # ACC, P, T and flags are read and written in E
        ("MOVL ACC,@0 | ADDL ACC,@2 | MOVL P,@ACC | MOV T,@AL", 0),
        # a read of a word that was just written
        ("MOV @0,AL | MOV AH,@0", 3),
        ("MOV @0,AL | NOP | MOV AH,@0", 2),
        ("MOV @0,AL | NOP | NOP | MOV AH,@0", 1),
        ("MOV @0,AL | NOP | NOP | NOP | MOV AH,@0", 0),
        ("MOV @0,AL | MOV AH,@1", 0),
        ("MOVL @0,ACC | MOV AH,@1", 3),  # half of what is written
        ("MOV @1,AL | MOVL ACC,@0", 3),  # half of what is read
        ("INC @0 | MOV AL,@0", 3),
        ("INC @0 | INC @0", 3),  # INC reads too
        ("MOV @0,AL | MOV @0,AH", 0),
        ("MOV @0,AL | MOV @1,AL | MOV AH,@0 | MOV AL,@1", 2),
        ("PUSH AL | POP AL", 3),
    ],
)
def test_stalls(code: str, expected: int):
    body = "\n".join(f" {line.strip()}" for line in code.split("|"))
    if "LCR" in code:
        body = " MOVL XAR6,#there\n MOVL @0,XAR6\n NOP\n NOP\n NOP\n" + body + "\nthere: NOP"
    assert stalls(body.replace("AL |", "AL\n").replace("PUSH AL", "PUSH @AL").replace("POP AL", "POP @AL")) == expected


@pytest.mark.parametrize("code", ["MOV32 @ACC,*(0:0x0F1A)", "MOV32 *(0:0x0F12),@ACC", "MOV32 *(0:0x0F2E),@XAR4"])
def test_a_move_between_fpu_and_cpu_takes_one_cycle(code: str):
    """R2H, R0H and R7H by address: no wait states of frame 0, as between registers [SPRUEO2A 4.2]."""
    assert cycles(f" {code}") - cycles("") == 1


@pytest.mark.parametrize(("enabled", "took"), [(True, 3), (False, 0)])
def test_open_stalls(enabled: bool, took: int):
    code = " MOV @0,AL\n MOV AH,@0"
    assert cycles(code, stalls=enabled) - cycles(" NOP\n NOP") == took


@pytest.mark.parametrize("took", [7, 4])
def test_open_b_unc_cycles(took: int):
    assert cycles(" B there,UNC\nthere:", b_unc_cycles=took) - cycles("") == took


@pytest.mark.parametrize("took", [1, 2])
def test_open_push_acc_cycles(took: int):
    assert cycles(" PUSH ACC", push_acc_cycles=took) - cycles("") == took


@pytest.mark.parametrize("more", [1, 0])
def test_open_odd_32bit_target(more: int):
    """The same code at an even and an odd address: at the odd one, half of a 32-bit instruction needs another fetch."""
    even, odd = (
        cycles(f" .align 2\n LB #there\n{pad}there: MOVL XAR6,#0x12345\n", odd_32bit_target=more)
        for pad in ("", " .space 1\n")
    )
    assert odd - even == more


@pytest.mark.parametrize("more", [0, 1])
def test_open_saram_conflict(more: int):
    """Code and data in L1 conflict; data in another block does not."""
    rig = Rig(f"{HEAD}{BEGIN} MOV AL,@0\n ESTOP0\n", saram_conflict=more).run()
    assert "system.saram_conflict" in rig.dsp.touched
    assert cycles(" MOV AL,@0", saram_conflict=more) - cycles(" MOV AL,@0") == more
    twice = " MOV AL,@0\n MOV AL,@1"
    assert cycles(twice, saram_conflict=more) - cycles(twice) == 2 * more
    assert cycles(" MOVW DP,#0x8000 >> 6\n MOV AL,@0", saram_conflict=more) - cycles(" MOVW DP,#0\n MOV AL,@0") == 0


@pytest.mark.parametrize(("bits", "repeats"), [(16, 0x102), (8, 0x02)])
def test_open_rptc_width(bits: int, repeats: int):
    rig = Rig(HEAD + " MOVL XAR1,#0x102\n MOVL XAR6,#0\n RPT @AR1\n || NOP *XAR6++\n ESTOP0", rptc_width=bits).run()
    assert rig.cpu.xar[6] == repeats + 1


# Program memory with wait states ------------------------------------------------------------------------------------


def from_l4(code: str, **options: Value) -> int:
    """Return the additional cycles of code in L4 compared with L1; both are reached by a jump."""

    def at(base: int) -> int:
        return ended(HEAD + f' LB #there\n .sect "code", {base:#x}\nthere: {code}\n ESTOP0\n .space 8\n', **options)

    return at(L4) - at(L1 + 0x800)


@pytest.mark.parametrize(
    ("code", "more"),
    [
        ("NOP", 1),  # the first fetch; ESTOP0 is fetched with it
        ("NOP\n" * 8, 1),  # 16-bit instructions at full speed: each fetch brings two
        (
            "MOVL XAR6,#1\n" * 8,
            1 + 8,
        ),  # 32-bit ones at half speed: 17 fetches with that of ESTOP0, less the last two, which overlap
        ("MPYB P,T,#0\n" + "MOVL XAR6,#1\n" * 2, 3),
        ("RPT #20\n || NOP\n" + "MOVL XAR6,#1\n" * 3, 1),  # meanwhile the queue is filled
        (
            "RPT #20\n || NOP\n" + "MOVL XAR6,#1\n" * 9,
            1 + 3,
        ),  # the queue holds four units; a fifth is fetched as the first is taken
        ("LB #there + 4\n" + "NOP\n" * 4, 2),  # a jump waits for a new fetch
    ],
)
def test_code_in_memory_with_a_wait_state(code: str, more: int):
    assert from_l4("\n ".join(code.strip().split("\n"))) == more


# Instructions of several cycles -------------------------------------------------------------------------------------


@pytest.mark.parametrize("call", ["LCR #f", "LCR *XAR7"])
@pytest.mark.parametrize(("nops", "took"), [(0, 4), (1, 5), (2, 6), (3, 7), (4, 8)])
def test_a_return_does_not_wait_for_the_return_address(call: str, nops: int, took: int):
    """LCR leaves D2 in its first cycle and pushes in W, four cycles later; LRETR enters D2 at the earliest then.

    cycle          1   2   3   4   5   6   7
    LCR            D2  R1  R2  E   W            pushes RPC
    LRETR                          D2  R1  R2   reads it
    """
    before = " MOVL XAR7,#f\n" + f" {call}\n" + " ESTOP0\n"
    whole = cycles(f"{before}f:" + " NOP\n" * nops + " LRETR\n", odd_32bit_target=0)
    assert whole - cycles(" MOVL XAR7,#0") == 4 + took


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        # an instruction that occupies D2 for several cycles writes in the last of them
        ("PUSH @AL | POP AL", 3),
        ("MOV *(0:0x9100),@AL | MOV AH,@0", 3),
        ("MOV *(0:0x9100),@AL | NOP | MOV AH,@0", 2),
        # one that occupies it until it has left E or W has then written: N + 4 is N + 1 passes and 3 cycles to E
        ("NORM ACC,XAR4++ | MOV AL,*XAR4", 0),
        ("PUSH DP:ST1 | NOP | NOP | NOP | NOP | POP DP:ST1 | MOV AL,@0", 0),
    ],
)
def test_writers_of_several_cycles(code: str, expected: int):
    body = "\n".join(f" {line.strip()}" for line in code.split("|"))
    assert stalls(body.replace("POP AL", "POP @AL")) == expected


def test_passes_of_rpt_do_not_stall():
    """RPT takes N + 4 cycles, though each pass needs the register that the previous one writes [SPRU430F 6, NORM]."""
    assert cycles(" RPT #9\n || NORM ACC,XAR6++") - cycles("") == 1 + 9 + 4


def test_the_first_pass_of_rpt_stalls():
    assert cycles(" MOVL XAR6,@0\n RPT #9\n || NORM ACC,XAR6++") - cycles(" NOP\n RPT #9\n || NORM ACC,XAR6++") == 2


def ar(*numbers: int) -> int:
    return sum(1 << number for number in numbers)


@pytest.mark.parametrize(
    ("field", "registers"),
    [
        (0x00, DP),  # @6bit
        (0x3F, DP),
        (0x40, SP),  # *-SP[6bit]
        (0x7F, SP),
        (0x80, ar(0)),  # *XAR0++
        (0x8F, ar(7)),  # *--XAR7
        (0x90, ar(0)),  # *+XAR0[AR0]
        (0x97, ar(7, 0)),
        (0x98, ar(0, 1)),  # *+XAR0[AR1]
        (0x9F, ar(7, 1)),
        (0xA0, 0),  # @AR0 is a register, so there is no address
        (0xA7, 0),
        (0xA9, 0),  # @AL
        (0xAE, BY_ARP | ar(0)),  # *0++
        (0xAF, BY_ARP | ar(0)),  # *0--
        (0xB0, BY_ARP),  # *,ARP0
        (0xB8, BY_ARP),  # *
        (0xBB, BY_ARP | ar(0)),  # *BR0++
        (0xBC, BY_ARP | ar(0)),  # *BR0--
        (0xBD, SP),  # *SP++
        (0xBE, SP),  # *--SP
        (0xBF, ar(6, 1)),  # *AR6%++
        (0xC3, ar(3)),  # *+XAR3[0]
        (0xFF, ar(7)),
    ],
)
def test_the_registers_of_an_address(field: int, registers: int):
    assert addressing(field) == registers


WAITS = 5


def begun(depth: int = DEPTH) -> FetchQueue:
    """Return a queue after a jump to address 0, whose first instruction is executed in cycle 5."""
    queue = FetchQueue()
    queue.begin(0, 0, 2, WAITS, WAITS, depth)
    assert queue.wait(0, 0, 1) == 5
    return queue


def there(queue: FetchQueue, unit: int) -> int:
    """Return the earliest cycle of an instruction in this unit, if all before it are executed by cycle 5."""
    return queue.wait(0, 4 * unit, 4 * unit + 1)


@pytest.mark.parametrize(("unit", "cycle"), [(1, 11), (2, 17), (3, 23)])
def test_units_are_fetched_one_after_the_other(unit: int, cycle: int):
    assert there(begun(), unit) == cycle


@pytest.mark.parametrize(
    ("cycle", "waits", "unit", "later"),
    [
        (8, 3, 1, 11),  # waits for the fetch of unit 1
        (8, 3, 2, 23),  # unit 2 is fetched after the read
        (10, 1, 2, 23),
        (11, 0, 2, 23),  # between two fetches
        (12, 5, 2, 17),  # waits for the fetch of unit 2
        (12, 5, 3, 29),
        (23, 0, 3, 23),  # all units of the queue are already fetched
    ],
)
def test_a_read_waits_for_the_current_fetch_and_delays_the_next_one(cycle: int, waits: int, unit: int, later: int):
    queue = begun()
    assert queue.read(cycle, WAITS) == waits
    assert there(queue, unit) == later


def test_a_read_directly_after_another_precedes_the_next_fetch():
    queue = begun()
    assert (queue.read(8, WAITS), queue.read(17, WAITS)) == (3, 0)
    assert there(queue, 2) == 29


def test_a_fetch_that_waits_for_a_free_place_also_waits_for_the_read():
    """Unit 4 takes the place of unit 0, which is executed until cycle 31; the read ends in cycle 36."""
    queue = begun()
    assert queue.read(30, WAITS) == 0
    assert queue.wait(31, 1, 4) == 0
    assert there(queue, 4) == 42


def test_a_queue_of_half_the_depth_fetches_the_third_unit_after_the_first_is_executed():
    queue = begun(DEPTH // 2)
    assert queue.wait(31, 1, 4) == 0
    assert there(queue, 1) == 11
    assert there(queue, 2) == 31 + 6

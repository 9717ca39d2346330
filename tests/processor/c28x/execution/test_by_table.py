"""One case per line: an instruction, registers and memory before, registers and memory after [SPRU430F, SPRUEO2A].

XAR4 is 0x9000 and XAR7 is 0xA000 unless the line sets them. Names in a line:

- w, w1, d: the word at 0x9000, the next one, and the 32 bits at 0x9000; d2: the 32 bits at 0x9002
- prog: the 32 bits at 0xA000
- s0, s1: the words at 0x400, where SP points, and 0x401
- m9005: the word at 0x9005, and so on; far: the word at 0x3FA000
- f0 to f7: R0H to R7H as floats; r0 to r7: as bits; x0 to x7: XAR0 to XAR7
- took: cycles
"""

from __future__ import annotations

import re
import struct

import pytest

from tests.processor.c28x.execution.flat import Flat, loaded

CASES = """
ABS ACC                   | acc=0xFFFFFFFE c=1                | acc=2 c=0 n=0 z=0
ABS ACC                   | acc=0x80000000 ovm=1              | acc=0x7FFFFFFF v=1
ABS ACC                   | acc=0x80000000                    | acc=0x80000000 v=1 n=1
ABSTC ACC                 | acc=0xFFFFFFFE tc=1               | acc=2 tc=0
ADRK #5                   | arp=4                             | x4=0x9005
SBRK #5                   | arp=4                             | x4=0x8FFB
AND IER,#0xF0             | ier=0x33                          | ier=0x30
OR IER,#0xF0              | ier=0x33                          | ier=0xF3
MOV IER,*XAR4             | w=0x180                           | ier=0x180
MOV *XAR4,IER             | ier=0x180                         | w=0x180
AND IFR,#0xF0             | ifr=0x33                          | ifr=0x30
OR IFR,#0xF0              | ifr=0x33                          | ifr=0xF3
BAR 0x8020,AR1,AR2,EQ     | x1=0x10005 x2=0x20005             | pc=0x8020
BAR 0x8020,AR1,AR2,EQ     | x1=5 x2=6                         | pc=0x8002
BAR 0x8020,AR1,AR2,NEQ    | x1=5 x2=6                         | pc=0x8020
BAR 0x8020,AR1,AR2,NEQ    | x1=5 x2=0x30005                   | pc=0x8002
POP ST1                   | sp=0x401 s0=0x1F5F st1=0xA0       | st1=0x1FFF sp=0x400
POP ST1                   | sp=0x401 s0=0x1FFF st1=0          | st1=0x1F5F sp=0x400
ASP                       | sp=0x401 st1=0x0A0B               | sp=0x402 st1=0x0A1B
ASP                       | sp=0x402 st1=0x0A1B               | sp=0x402 st1=0x0A0B
NASP                      | sp=0x402 st1=0x0A1B               | sp=0x401 st1=0x0A0B
NASP                      | sp=0x402 st1=0x0A0B               | sp=0x402 st1=0x0A0B
SETC XF                   | st1=0x0A0B                        | st1=0x1A0B
CLRC XF                   | st1=0x1A0B                        | st1=0x0A0B
SETC OBJMODE              | st1=0x080B                        | st1=0x0A0B
SETC M0M1MAP              | st1=0x020B                        | st1=0x0A0B
CLRC AMODE                | st1=0x0B0B                        | st1=0x0A0B
SETC SXM,C,INTM           | st1=0x0A0A                        | sxm=1 c=1 st1=0x0A0B
CLRC SXM,OVM,TC,DBGM      | sxm=1 ovm=1 tc=1 st1=0x0A0B       | sxm=0 ovm=0 tc=0 st1=0x0A09
EALLOW                    | st1=0x0A0B                        | st1=0x0A4B
EDIS                      | st1=0x0A4B                        | st1=0x0A0B
ABORTI                    | st1=0x0A09                        | st1=0x0A0B
CMP64 ACC:P               | acc=0x80000000 v=1                | n=0 z=0 v=0
CMP64 ACC:P               | acc=0 p=0                         | n=0 z=1
CMPL ACC,P<<PM            | acc=8 p=4 pm=0                    | z=1 n=0 c=1
CMPR 0                    | arp=2 x2=0x10005 x0=5             | tc=1
CMPR 1                    | arp=2 x2=4 x0=5                   | tc=1
CMPR 2                    | arp=2 x2=0xFFFF x0=5              | tc=1
CMPR 3                    | arp=2 x2=5 x0=5                   | tc=0
DMAC ACC:P,*XAR4,*XAR7    | d=0x00020003 prog=0x00050007 pm=1 acc=1 p=2 | acc=11 p=23 xt=0x00020003 x7=0xA000
DMAC ACC:P,*XAR4,*XAR7++  | d=0xFFFF0003 prog=0x00050007 pm=1 | acc=0xFFFFFFFB p=21 x7=0xA002 n=1
FLIP AL                   | acc=0x8001                        | acc=0x8001 n=1
FLIP AH                   | acc=0x00010000                    | acc=0x80000000 n=1
FFC XAR7,#0x338000        |                                   | pc=0x338000 x7=0x8002
LB *XAR7                  |                                   | pc=0xA000
LB #0x338000              |                                   | pc=0x338000
LC #0x338000              |                                   | pc=0x338000 s0=0x8002 s1=0 sp=0x402
LC *XAR7                  |                                   | pc=0xA000 s0=0x8001 s1=0 sp=0x402
LCR *XAR7                 | rpc=0x312345                      | pc=0xA000 s0=0x2345 s1=0x31 rpc=0x8001
LRET                      | sp=0x402 s0=0x2345 s1=0x31        | pc=0x312345 sp=0x400
LRETE                     | sp=0x402 s0=0x2345 s1=0x31        | pc=0x312345 st1=0x0A0A
LOOPZ *XAR4,#4            | w=3                               | pc=0x8000 z=1
LOOPZ *XAR4,#4            | w=7                               | pc=0x8002 z=0
LOOPNZ *XAR4,#4           | w=7                               | pc=0x8000 z=0
LOOPNZ *XAR4,#4           | w=3                               | pc=0x8002 z=1
IMACL P,*XAR4,*XAR7       | d=0xFFFFFFFF prog=3 pm=1 acc=0xFFFFFFFF p=1 | acc=0 p=0xFFFFFFFD c=1 ovc=1 x7=0xA000
IMACL P,*XAR4,*XAR7++     | d=2 prog=3 pm=0 p=1               | acc=1 p=12 x7=0xA002
QMACL P,*XAR4,*XAR7       | d=0x40000000 prog=8 pm=1 p=5      | acc=5 p=2 x7=0xA000
QMACL P,*XAR4,*XAR7++     | d=0xC0000000 prog=8 pm=1 p=5      | acc=5 p=0xFFFFFFFE x7=0xA002
MAC P,*XAR4,0:0xA000      | w=3 prog=0xFFFE pm=1 p=7 acc=1    | acc=8 p=0xFFFFFFFA xt=0x30000
MAC P,*XAR4,*XAR7         | w=3 prog=0xFFFE pm=1 p=7          | acc=7 p=0xFFFFFFFA x7=0xA000
MAC P,*XAR4,*XAR7++       | w=3 prog=0xFFFE pm=1              | p=0xFFFFFFFA x7=0xA001
MAX AL,*XAR4              | acc=5 w=6                         | acc=6 v=1 n=1 z=0 c=0
MAX AL,*XAR4              | acc=5 w=0xFFFF                    | acc=5 v=0 n=0
MIN AH,*XAR4              | acc=0x50000 w=0xFFFF              | acc=0xFFFF0000 v=1
MAXL ACC,*XAR4            | acc=5 d=6                         | acc=6 v=1 n=1 z=0
MINL ACC,*XAR4            | acc=5 d=0xFFFFFFFF                | acc=0xFFFFFFFF v=1 n=0
MAXCUL P,*XAR4            | p=5 d=3 n=1 z=0                   | p=3
MAXCUL P,*XAR4            | p=5 d=6 n=0 z=1                   | p=6 v=1
MAXCUL P,*XAR4            | p=5 d=6 n=0 z=0                   | p=5 v=0
MINCUL P,*XAR4            | p=5 d=6 n=0 z=0                   | p=6
MINCUL P,*XAR4            | p=5 d=3 n=0 z=1                   | p=3 v=1
MOV *(0:0x9000),@AL       | acc=0x1234                        | w=0x1234
MOV @AL,*(0:0x9000)       | w=0x8234                          | acc=0x8234 n=1 z=0
MOV DP,#5                 | dp=0xFFFF                         | dp=0xFC05
MOV @AR0,AL               | acc=5 x0=0x12340000               | x0=0x12340005
MOV AL,@AR0               | x0=0x12345678                     | acc=0x5678 x0=0x12345678
MOVL @XAR0,ACC            | acc=5                             | x0=5
MOV AL,@AH                | acc=0x12345678                    | acc=0x12341234
MOV AH,@AL                | acc=0x12345678                    | acc=0x56785678
MOV AL,@PH                | p=0x12345678                      | acc=0x1234
MOV AL,@PL                | p=0x12345678                      | acc=0x5678
MOV AL,@T                 | xt=0x12345678                     | acc=0x1234
MOV AL,@SP                | sp=0x456                          | acc=0x456
MOV @PH,AL                | acc=7 p=0x12345678                | p=0x00075678
MOV @PL,AL                | acc=7 p=0x12345678                | p=0x12340007
MOV @T,AL                 | acc=7 xt=0x12345678               | xt=0x00075678
MOV @SP,AL                | acc=0x456                         | sp=0x456
MOVL ACC,@P               | p=0x12345678                      | acc=0x12345678
MOVL ACC,@XT              | xt=0x12345678                     | acc=0x12345678
MOVL ACC,@XAR0            | x0=0x12345678                     | acc=0x12345678
MOV *XAR4,AR3             | x3=0x12345678                     | w=0x5678
MOV *XAR4,AL,EQ           | acc=7 z=1 w=1                     | w=7
MOV *XAR4,AL,EQ           | acc=7 z=0 w=1                     | w=1
MOVB *XAR4,#9,TC          | tc=1                              | w=9
MOVL *XAR4,ACC,NOV        | acc=7 v=1 d=1                     | d=1 v=0
MOVL *XAR4,ACC,OV         | acc=7 v=1 d=1                     | d=7 v=0
MOV XAR3,PC               |                                   | x3=0x8000
MOVAD T,*XAR4             | w=5 p=3 pm=1 acc=1                | acc=4 xt=0x50000 w1=5
MOVDL XT,*XAR4            | d=0x12345678                      | xt=0x12345678 d2=0x12345678
DMOV *XAR4                | w=5                               | w1=5
MOVB AL.MSB,*XAR4         | w=0x1234 acc=0x5678               | acc=0x3478
MOVB AH.LSB,*XAR4         | w=0x1284 acc=0x5678               | acc=0x00845678 n=0
MOVB *XAR4,AL.MSB         | w=0x1234 acc=0x5678               | w=0x1256
MOVU *XAR4,OVC            | ovc=-1                            | w=63
NEG ACC                   | acc=1                             | acc=0xFFFFFFFF n=1 c=0
NEG ACC                   | acc=0x80000000 ovm=1              | acc=0x7FFFFFFF v=1
NEG AL                    | acc=0x8000                        | acc=0x8000 v=1 n=1
NEG AH                    | acc=0                             | acc=0 c=1 z=1
NEG64 ACC:P               | acc=0 p=1                         | acc=0xFFFFFFFF p=0xFFFFFFFF n=1 c=0
NEG64 ACC:P               | acc=0x80000000 p=0 ovm=1 n=1 z=1  | acc=0x7FFFFFFF p=0xFFFFFFFF v=1 n=0 z=0
NEG64 ACC:P               | acc=0x80000000 p=0 z=1            | acc=0x80000000 p=0 v=1 n=1 z=0
NEGTC ACC                 | acc=1 tc=0                        | acc=1
NEGTC ACC                 | acc=1 tc=1                        | acc=0xFFFFFFFF
NORM ACC,*                | acc=1 arp=2 x2=5                  | acc=2 x2=5 tc=0
NORM ACC,*++              | acc=1 arp=2 x2=5                  | acc=2 x2=6 tc=0
NORM ACC,*--              | acc=1 arp=2 x2=5                  | acc=2 x2=4 tc=0
NORM ACC,*0++             | acc=1 arp=2 x2=5 x0=3             | acc=2 x2=8 tc=0
NORM ACC,*0--             | acc=0x40000000 arp=2 x2=5 x0=3    | acc=0x40000000 x2=5 tc=1
NORM ACC,XAR2--           | acc=1 x2=5                        | acc=2 x2=4
PWRITE *XAR7,*XAR4        | w=0x1234                          | prog=0x1234
ROL ACC                   | acc=0x80000001 c=0                | acc=2 c=1
ROR ACC                   | acc=0x80000001 c=0                | acc=0x40000000 c=1
SUBCU ACC,*XAR4           | acc=0x8000 w=1 c=0                | acc=1 c=1 z=0 n=0
SUBCU ACC,*XAR4           | acc=0x7FFF w=1 c=1                | acc=0xFFFE c=0
SAT64 ACC:P               | acc=1 p=2 ovc=-3 c=1              | acc=0x80000000 p=0 v=1 ovc=0 c=0
SPM -4                    |                                   | pm=5
TBIT *XAR4,#3             | w=8                               | tc=1
TBIT *XAR4,T              | w=8 xt=0xC0000                    | tc=1
TCLR *XAR4,#3             | w=0xF                             | tc=1 w=7
TSET *XAR4,#3             | w=7                               | tc=0 w=15
TEST ACC                  | acc=0x80000000                    | n=1 z=0
XB *AL                    | acc=0x1234                        | pc=0x3F1234
XB 0x3F1234,*,ARP5        | arp=2                             | pc=0x3F1234 arp=5
XB 0x3F1234,EQ            | z=1                               | pc=0x3F1234
XB 0x3F1234,EQ            | z=0                               | pc=0x8002
XBANZ 0x3F1234,*          | arp=2 x2=1                        | pc=0x3F1234 x2=1
XBANZ 0x3F1234,*++        | arp=2 x2=1                        | pc=0x3F1234 x2=2
XBANZ 0x3F1234,*--        | arp=2 x2=0x10000                  | pc=0x8002 x2=0xFFFF
XBANZ 0x3F1234,*0++       | arp=2 x2=1 x0=3                   | pc=0x3F1234 x2=4
XBANZ 0x3F1234,*0--       | arp=2 x2=5 x0=3                   | pc=0x3F1234 x2=2
XBANZ 0x3F1234,*,ARP5     | arp=2 x2=1                        | pc=0x3F1234 x2=1 arp=5
XBANZ 0x3F1234,*++,ARP5   | arp=2 x2=1                        | x2=2 arp=5
XBANZ 0x3F1234,*--,ARP5   | arp=2 x2=1                        | x2=0 arp=5
XBANZ 0x3F1234,*0++,ARP5  | arp=2 x2=1 x0=3                   | x2=4 arp=5
XBANZ 0x3F1234,*0--,ARP5  | arp=2 x2=5 x0=3                   | x2=2 arp=5
XCALL *AL                 | acc=0x1234                        | pc=0x3F1234 s0=0x8001 sp=0x401
XCALL 0x3F1234,*,ARP5     |                                   | pc=0x3F1234 s0=0x8002 arp=5
XCALL 0x3F1234,EQ         | z=1                               | pc=0x3F1234 s0=0x8002 sp=0x401
XCALL 0x3F1234,EQ         | z=0                               | pc=0x8002 sp=0x400
XRETC UNC                 | sp=0x401 s0=0x1234                | pc=0x3F1234 sp=0x400
XRETC EQ                  | sp=0x401 s0=0x1234 z=0            | pc=0x8001 sp=0x401
XMAC P,*XAR4,*(0x3FA000)  | w=3 far=5 pm=1 p=2                | acc=2 p=15 xt=0x30000
XMACD P,*XAR4,*(0x3FA000) | w=3 far=5 pm=1 p=2                | acc=2 p=15 w1=3
XPREAD *XAR4,*(0x3FA000)  | far=5                             | w=5
XPREAD *XAR4,*AL          | far=5 acc=0xA000                  | w=5
XPWRITE *AL,*XAR4         | w=5 acc=0xA000                    | far=5
ZALR ACC,*XAR4            | w=5                               | acc=0x58000
IACK #5                   |                                   | pc=0x8002
ESTOP1                    |                                   | pc=0x8001
RPTB 0x800A,*XAR4         | w=3                               | rb=0x44090003
ABSF32 R0H,R1H            | f1=-2.5                           | f0=2.5 stf=0
ADDF32 R0H,#1.5,R1H       | f1=2.0                            | f0=3.5
SUBF32 R0H,#1.5,R1H       | f1=2.0                            | f0=-0.5
MPYF32 R0H,#1.5,R1H       | f1=2.0                            | f0=3.0
NEGF32 R0H,R1H            | f1=2.0                            | f0=-2.0 stf=4
NEGF32 R0H,R1H,EQ         | f1=2.0 stf=0                      | f0=2.0 stf=0
CMPF32 R0H,#2.0           | f0=1.0                            | stf=4
CMPF32 R0H,R1H            | f0=1.0 f1=1.0                     | stf=8
MAXF32 R0H,R1H            | f0=1.0 f1=2.0                     | f0=2.0 stf=4
MAXF32 R0H,#0.5           | f0=1.0                            | f0=1.0 stf=0
MINF32 R0H,R1H            | f0=1.0 f1=-2.0                    | f0=-2.0 stf=0
MINF32 R0H,#0.5           | f0=1.0                            | f0=0.5
MAXF32 R0H,R1H || MOV32 R2H,R3H | f0=1.0 f1=2.0 f2=3.0 f3=4.0 | f0=2.0 f2=4.0
MINF32 R0H,R1H || MOV32 R2H,R3H | f0=1.0 f1=2.0 f2=3.0 f3=4.0 | f0=1.0 f2=3.0
EINVF32 R0H,R1H           | f1=4.0                            | f0=0.25
EISQRTF32 R0H,R1H         | f1=4.0                            | f0=0.5
F32TOI16 R0H,R1H          | f1=-2.5                           | r0=0xFFFFFFFE
F32TOI16R R0H,R1H         | f1=-3.5                           | r0=0xFFFFFFFC
F32TOI32 R0H,R1H          | f1=-2.5                           | r0=0xFFFFFFFE
F32TOUI16 R0H,R1H         | f1=70000.0                        | r0=0xFFFF
F32TOUI16R R0H,R1H        | f1=3.5                            | r0=4
F32TOUI32 R0H,R1H         | f1=-2.5                           | r0=0
FRACF32 R0H,R1H           | f1=-2.25                          | f0=-0.25
I16TOF32 R0H,R1H          | r1=0x1FFFF                        | f0=-1.0
I16TOF32 R0H,*XAR4        | w=0xFFFF                          | f0=-1.0
I32TOF32 R0H,R1H          | r1=0xFFFFFFFF                     | f0=-1.0
I32TOF32 R0H,*XAR4        | d=5                               | f0=5.0
UI16TOF32 R0H,R1H         | r1=0x1FFFF                        | f0=65535.0
UI16TOF32 R0H,*XAR4       | w=0xFFFF                          | f0=65535.0
UI32TOF32 R0H,R1H         | r1=0x80000000                     | f0=2147483648.0
UI32TOF32 R0H,*XAR4       | d=0x80000000                      | f0=2147483648.0
ADDF32 R0H,R1H,R2H || MOV32 R3H,*XAR4 | f1=1.0 f2=2.0 d=0x40000000 | f0=3.0 f3=2.0
SUBF32 R0H,R1H,R2H || MOV32 R3H,*XAR4 | f1=1.0 f2=2.0 d=0x40000000 | f0=-1.0 f3=2.0
SUBF32 R0H,R1H,R2H || MOV32 *XAR4,R3H | f1=1.0 f2=2.0 r3=5    | f0=-1.0 d=5
MPYF32 R0H,R1H,R2H || MOV32 R3H,*XAR4 | f1=3.0 f2=2.0 d=0     | f0=6.0 r3=0 stf=40
MPYF32 R0H,R1H,R2H || MOV32 *XAR4,R3H | f1=3.0 f2=2.0 r3=5    | f0=6.0 d=5
MPYF32 R0H,R1H,R2H || SUBF32 R3H,R1H,R2H | f1=3.0 f2=2.0      | f0=6.0 f3=1.0
MACF32 R7H,R6H,R0H,R1H,R2H || MOV32 R3H,*XAR4 | f7=1.0 f6=2.0 f1=3.0 f2=4.0 d=7 | f7=3.0 f0=12.0 r3=7
MOV16 *XAR4,R1H           | r1=0x12345678                     | w=0x5678
MOV32 *XAR4,R1H           | r1=0x12345678                     | d=0x12345678
MOV32 *XAR4,STF           | stf=0x20C                         | d=0x20C
MOV32 STF,*XAR4           | d=0xFFFFFFFF                      | stf=0x27F
MOV32 R1H,*XAR4           | d=0x80000001                      | r1=0x80000001 stf=24
MOV32 R1H,*XAR4,EQ        | d=5 stf=0                         | r1=0 stf=0
MOV32 R1H,R2H             | f2=-1.0                           | f1=-1.0 stf=20
MOVD32 R1H,*XAR4          | d=5                               | r1=5 d2=5
MOVIZ R1H,#0x1234         | r1=5                              | r1=0x12340000
MOVXI R1H,#0x1234         | r1=0xABCD0005                     | r1=0xABCD1234
SETFLG RNDF32=1,TF=0      | stf=0x44                          | stf=0x204
SAVE RNDF32=1             | f1=1.0 stf=4                      | stf=0x80000204
TESTTF EQ                 | stf=8                             | stf=0x48
TESTTF NEQ                | stf=0x48                          | stf=8
MOVST0 TF,LVF             | stf=0x41                          | c=1 tc=1 v=1 stf=0x40
SWAPF R1H,R2H             | f1=1.0 f2=2.0                     | f1=2.0 f2=1.0
SWAPF R1H,R2H,EQ          | f1=1.0 f2=2.0 stf=0               | f1=1.0 f2=2.0
ZERO R1H                  | f1=1.0                            | r1=0
ZEROA                     | f1=1.0 f7=2.0                     | r1=0 r7=0
SBF 0x8005,EQ             | z=1                               | pc=0x8005 took=4
SBF 0x8005,EQ             | z=0                               | pc=0x8001 took=4
SBF 0x8005,NEQ            | z=0                               | pc=0x8005 took=4
SBF 0x8005,NEQ            | z=1                               | pc=0x8001 took=4
SBF 0x8005,TC             | tc=1                              | pc=0x8005 took=4
SBF 0x8005,TC             | tc=0                              | pc=0x8001 took=4
SBF 0x8005,NTC            | tc=0                              | pc=0x8005 took=4
SBF 0x8005,NTC            | tc=1                              | pc=0x8001 took=4
BANZ 0x8010,AR3--         | x3=0x12340002                     | pc=0x8010 x3=0x12340001 took=4
BANZ 0x8010,AR3--         | x3=0x12340000                     | pc=0x8002 x3=0x1234FFFF took=2
LCR #0x338000             | rpc=0x312345                      | pc=0x338000 s0=0x2345 s1=0x31 rpc=0x8002 sp=0x402 took=4
LRETR                     | sp=0x402 s0=0x2345 s1=0x31 rpc=0x8002 | pc=0x8002 rpc=0x312345 sp=0x400 took=4
PUSH AR1:AR0              | x0=0xAAAA0001 x1=0xBBBB0002       | s0=1 s1=2 sp=0x402
PUSH T:ST0                | xt=0x30000                        | s0=0 s1=3
PUSH DP:ST1               | dp=4                              | s0=0x0A0B s1=4
CSB ACC                   | acc=1                             | xt=0x1E0000 tc=0 z=0 n=0
CSB ACC                   | acc=0xFFFFFFFF                    | xt=0x1F0000 tc=1 n=1
CSB ACC                   | acc=0x40000000                    | xt=0 tc=0
CSB ACC                   | acc=0                             | xt=0x1F0000 tc=0 z=1
CSB ACC                   | acc=0x80000000                    | xt=0 tc=1
SAT ACC                   | acc=5 ovc=0 v=1 c=1               | acc=5 v=0 ovc=0 c=0
SAT ACC                   | acc=5 ovc=3 c=1                   | acc=0x7FFFFFFF v=1 ovc=0 c=0
SAT ACC                   | acc=5 ovc=-1 c=1                  | acc=0x80000000 v=1 ovc=0 c=0
MOVL XAR7,*XAR7++         | x7=0x9000 d=0x56781234            | x7=0x56781234
MOVL ACC,*XAR4++          | x4=0x9001 w=1 w1=2                | acc=0x20001 x4=0x9003
MOV AL,*AR6%++            | x1=0xBBBB0002 x6=0x39001 m39001=7 | acc=7 x6=0x39002 arp=6
MOV AL,*AR6%++            | x1=2 x6=0x39002                   | x6=0x39000
MOV AL,*XAR2++            | x2=0x9000 m9000=7                 | acc=7 x2=0x9001 arp=2
MOV AL,*--XAR2            | x2=0x9001 m9000=7                 | acc=7 x2=0x9000
MOV AL,*+XAR2[5]          | x2=0x9000 m9005=7                 | acc=7 x2=0x9000
MOV AL,*+XAR2[AR0]        | x2=0x9000 x0=0xAAAA0003 m9003=7   | acc=7 x2=0x9000
MOV AL,*+XAR2[AR1]        | x2=0x9000 x1=0xBBBB0007 m9007=7   | acc=7 x2=0x9000
MOV AL,*                  | arp=2 x2=0x9000 m9000=7           | acc=7 x2=0x9000 arp=2
MOV AL,*++                | arp=2 x2=0x9000 m9000=7           | acc=7 x2=0x9001
MOV AL,*--                | arp=2 x2=0x9000 m9000=7           | acc=7 x2=0x8FFF
MOV AL,*0++               | arp=2 x2=0xFFFF x0=0xAAAA0003 mFFFF=7 | acc=7 x2=0x10002
MOV AL,*0--               | arp=2 x2=0x10000 x0=0xAAAA0003 m10000=7 | acc=7 x2=0xFFFD
MOV AL,*BR0++             | arp=2 x2=0x9000 x0=8 m9000=7      | acc=7 x2=0x9008
MOV AL,*,ARP5             | arp=2 x2=0x9000 m9000=7           | acc=7 x2=0x9000 arp=5
MOV AL,*-SP[3]            | m3FD=7                            | acc=7 sp=0x400
MOV AL,@0x3F              | dp=0x1C50 m7143F=7                | acc=7
MOV AL,*SP++              | s0=7                              | acc=7 sp=0x401
MOV AL,*--SP              | m3FF=7                            | acc=7 sp=0x3FF
CMPF32 R0H,R1H            | f0=1 f1=2                         | stf=4
CMPF32 R0H,R1H            | f0=2 f1=1                         | stf=0
CMPF32 R0H,R1H            | f0=0.0 f1=-0.0                    | stf=8
CMPF32 R0H,R1H            | f0=-1 f1=1e-40                    | stf=4
MOVST0 NF,ZF              | stf=4 z=1                         | n=1 z=0
MPYF32 R0H,R1H,R2H || ADDF32 R1H,R3H,R4H | f1=1 f2=2 f3=3 f4=4 | f0=2 f1=7
ADDF32 R3H,R1H,R2H || MOV32 *XAR4,R3H | f1=1 f2=2 r3=5        | f3=3 d=5
MACF32 R3H,R2H,R2H,R4H,R5H || MOV32 R1H,*XAR4 | f2=2 f3=3 f4=4 f5=5 d=7 | f3=5 f2=20 r1=7
MPYF32 R0H,R1H,R2H        | r1=0x7F000000 r2=0x7F000000       | r0=0x7F800000 stf=1
MPYF32 R0H,R1H,R2H        | r1=0x00800000 r2=0x00800000 stf=1 | r0=0 stf=3
ADDF32 R0H,R1H,R2H        | f1=1 f2=2 stf=3                   | f0=3 stf=3
MOVB AL.LSB,*+XAR4[3]     | w1=0x1234                         | acc=0x12
MOVB AL.LSB,*+XAR4[2]     | w1=0x1234                         | acc=0x34
MOVB *+XAR4[3],AL.LSB     | w1=0x1234 acc=0x56                | w1=0x5634
MOVB *+XAR4[0],AL.LSB     | w=0x1234 acc=0x56                 | w=0x1256
MOV32 *(0:0x0F16),@ACC    | acc=0x12345678                    | r1=0x12345678 took=1
MOV32 @XAR3,*(0:0x0F16)   | r1=0x12345678                     | x3=0x12345678 took=1
"""
ROWS = [tuple(part.strip() for part in line.rsplit("|", 2)) for line in CASES.strip().splitlines()]
PLACES = {"w": 0x9000, "w1": 0x9001, "s0": 0x400, "s1": 0x401, "far": 0x3FA000}
PAIRS = {"d": 0x9000, "d2": 0x9002, "prog": 0xA000}
FLOATS = [f"f{n}" for n in range(8)]
NUMBERED = re.compile(r"([fxr])([0-7])")
ADDRESS = re.compile(r"m([0-9A-F]+)")


def given(text: str) -> dict[str, int]:
    """Parse names and values; a float is returned as its bits."""
    pairs = (pair.split("=") for pair in text.split())
    return {
        name: struct.unpack("<I", struct.pack("<f", float(value)))[0] if name in FLOATS else int(value, 0)
        for name, value in pairs
    }


def put(cpu: Flat, name: str, value: int) -> None:
    if numbered := NUMBERED.fullmatch(name):
        (cpu.put_xars if numbered[1] == "x" else cpu.put_floats)({int(numbered[2]): value})
    elif name in PAIRS:
        cpu.store32(PAIRS[name], value)
    elif name in PLACES or ADDRESS.fullmatch(name):
        cpu.store16(PLACES[name] if name in PLACES else int(name[1:], 16), value)
    else:
        assert hasattr(cpu, name)
        setattr(cpu, name, value)


def got(cpu: Flat, name: str) -> object:
    if numbered := NUMBERED.fullmatch(name):
        return (cpu.xar if numbered[1] == "x" else cpu.r)[int(numbered[2])]
    if name in PAIRS:
        return cpu.load32(PAIRS[name])
    return cpu.load16(PLACES[name]) if name in PLACES else getattr(cpu, name)


@pytest.mark.parametrize(("source", "before", "after"), ROWS, ids=[f"{row[0]} {row[1]}" for row in ROWS])
def test_case(source: str, before: str, after: str):
    cpu, expected = loaded(source), given(after)
    cpu.put_xars({4: 0x9000, 7: 0xA000})
    for name, value in given(before).items():
        put(cpu, name, value)
    took = cpu.step()
    assert {name: took if name == "took" else got(cpu, name) for name in expected} == expected


def test_saved_registers_are_restored():
    cpu = loaded("SAVE RNDF32=1\nZEROA\nRESTORE")
    cpu.r, cpu.stf = list(range(8)), 4
    for _ in range(3):
        cpu.step()
    assert (cpu.r, cpu.stf) == (list(range(8)), 4)

"""Programs in assembly for tests of boards: what public images do there, in few lines of our own.

RS485    sends a text on SCI-B at GPIO22, the driver enable at GPIO49; then off, on TXEMPTY or TXRDY
ECHO     SCI-A on GPIO35 and 36 at 4800 baud; timer 0's interrupt looks at it and uses the FPU, as main does
KEYPAD   drives a column on GPIO25 low, looks at the row on GPIO20, and says on SCI-C at GPIO63 what it saw
LINKED   one program, linked to RAM, or to flash with a function that start-up code copies to RAM
"""

from __future__ import annotations

RS485 = """
          .include "f28335.inc"
SCIB      .set  0x7750
          .reserve ".stack", 0x400, 0x300
          .sect ".text", 0x9000
_c_int00: MOV   @SP,#0x400
          LCR   #_start_chip
          EALLOW
          MOVW  DP,#PCLKCR0 >> 6
          OR    @PCLKCR0,#0x800     ; SCIBENCLK
          MOVW  DP,#GPAMUX2 >> 6
          OR    @GPAMUX2,#0xF000    ; SCITXDB, SCIRXDB
          OR    @GPBDIR+1,#2        ; GPIO49
          EDIS
          MOVW  DP,#SCIB >> 6
          MOV   @SCIB,#7            ; SCICCR
          MOV   @SCIB+3,#40         ; SCILBAUD: 115200
          MOV   @SCIB+1,#0x22       ; SCICTL1: out of SW RESET, TXENA
          MOVW  DP,#GPBSET >> 6
          MOV   @GPBSET+1,#2
          MOVL  XAR4,#_text
          MOVB  XAR0,#3
          MOVW  DP,#SCIB >> 6
next:     MOV   AL,*XAR4++
ready:    TBIT  @SCIB+4,#7          ; TXRDY
          SB    ready,NTC
          MOV   @SCIB+9,AL
          BANZ  next,AR0--
over:     TBIT  @SCIB+4,#LAST_WAIT
          SB    over,NTC
          MOVW  DP,#GPBCLEAR >> 6
          MOV   @GPBCLEAR+1,#2
          ESTOP0
_text:    .word 0x6D, 0x6F, 0x74, 0x6F
          .include "start.inc"
"""

ECHO = """
          .include "f28335.inc"
          .reserve ".stack", 0x400, 0x300
          .sect ".ebss", 0x8000
          .global _sum
_sum:     .long 0
          .sect ".text", 0x9000
          .global _looks
_c_int00: MOV   @SP,#0x400
          LCR   #_start_chip
          EALLOW
          MOVW  DP,#GPBMUX1 >> 6
          OR    @GPBMUX1,#0x0140    ; GPIO35 SCITXDA, GPIO36 SCIRXDA
          OR    @GPBQSEL1,#0x0300
          MOVL  XAR4,#_looks
          MOVL  XAR5,#TINT0
          MOVL  *XAR5,XAR4
          EDIS
          MOVW  DP,#SCICCR >> 6
          MOV   @SCICCR,#7
          MOV   @SCIHBAUD,#976 >> 8 ; 37.5 MHz / 8 / 4800 - 1
          MOV   @SCILBAUD,#976 & 0xFF
          MOV   @SCICTL1,#0x23
          MOVW  DP,#TIMER0PRD >> 6
          MOVL  XAR4,#75000 - 1     ; 500 us
          MOVL  @TIMER0PRD,XAR4
          MOV   @TIMER0TCR,#0x4020
          MOVW  DP,#PIECTRL >> 6
          MOV   @PIECTRL,#1
          MOV   @PIEIER1,#0x40
          OR    IER,#1
          MOVIZ R0H,#0x3F80         ; 1.0
          MOVIZ R1H,#0x3F80
          MOVW  DP,#_sum >> 6
          CLRC  INTM
count:    ADDF32 R0H,R0H,R1H        ; 1 and 1 and 1 ...
          NOP
          MOV32 @_sum,R0H
          SB    count,UNC

_looks:   ASP
          MOV32 *SP++,STF
          MOV32 *SP++,R0H
          MOV32 *SP++,R1H
          MOVIZ R0H,#0x4000
          MOVIZ R1H,#0x4040
          MPYF32 R0H,R0H,R1H
          NOP
          MOVW  DP,#SCICCR >> 6
          TBIT  @SCICCR+5,#6        ; SCIRXST.RXRDY
          SB    none,NTC
          MOV   AL,@SCIRXBUF
          MOV   @SCICCR+9,AL
none:     MOVW  DP,#PIEACK >> 6
          MOV   @PIEACK,#1
          MOV32 R1H,*--SP
          MOV32 R0H,*--SP
          MOV32 STF,*--SP
          NASP
          IRET
          .include "start.inc"
"""

KEYPAD = """
          .include "f28335.inc"
SCIC      .set  0x7770
GPBMUX2   .set  0x6F98
GPACLEAR  .set  0x6FC4
          .reserve ".stack", 0x400, 0x300
          .sect ".text", 0x9000
_c_int00: MOV   @SP,#0x400
          LCR   #_start_chip
          EALLOW
          MOVW  DP,#PCLKCR0 >> 6
          OR    @PCLKCR0,#0x20      ; SCICENCLK
          MOVW  DP,#GPBMUX2 >> 6
          OR    @GPBMUX2+1,#0x5000  ; SCIRXDC, SCITXDC
          OR    @GPADIR+1,#0x200    ; GPIO25
          EDIS
          MOVW  DP,#SCIC >> 6
          MOV   @SCIC,#7            ; SCICCR
          MOV   @SCIC+3,#40         ; SCILBAUD: 115200
          MOV   @SCIC+1,#0x22       ; SCICTL1
          MOVW  DP,#GPACLEAR >> 6
          MOV   @GPACLEAR+1,#0x200
          RPT   #9
       || NOP
          MOVB  AH,#0x75            ; u
          TBIT  @GPADAT+1,#4        ; GPIO20
          SB    say,TC
          MOVB  AH,#0x64            ; d
say:      MOVW  DP,#SCIC >> 6
          MOV   @SCIC+9,AH          ; SCITXBUF
          ESTOP0
          .include "start.inc"
"""

LINKED = """
          .include "f28335.inc"
          .reserve ".stack", 0x400, 0x300
          .sect "codestart", {start}
          LB    #_c_int00
          .sect ".text", {text}
_c_int00: MOV   @SP,#0x400
          LCR   #_start_chip
          MOVL  XAR6,#{ramfuncs}
          MOVL  XAR7,#_set_up_loaded
          RPT   #31
       || PREAD *XAR6++,*XAR7
          LCR   #_set_up
          ESTOP0
          .include "start.inc"
          .sect "ramfuncs", {ramfuncs}, {loaded}
_set_up_loaded .set {loaded}
          .global _set_up
_set_up:  EALLOW
          MOVW  DP,#GPADIR >> 6
          OR    @GPADIR+1,#8
          EDIS
          MOVW  DP,#SCICCR >> 6
          MOV   @SCICCR,#7
          MOV   @SCILBAUD,#40
          MOV   @SCICTL1,#0x23
          MOVW  DP,#GPATOGGLE >> 6
          MOV   @GPATOGGLE+1,#8
          LRETR
"""

"""Programs in assembly for tests of boards; each does in a few lines what a public image does on that board.

RS485    sends a text on SCI-B at GPIO22 with the driver enabled by GPIO49, and disables it on TXEMPTY or TXRDY
ECHO     SCI-A on GPIO35 and 36 at 4800 baud; the interrupt of timer 0 polls it and uses the FPU, as main does
SENDER   sends a character on SCI-A at 9600 baud every 10 ms, with a delay loop as in TI's DELAY_US
CLOCK    sets a clock byte by byte and reads it back; I2C-A's interrupt ends each transfer, its bytes are in the FIFOs
KEYPAD   drives a column on GPIO25 low, reads the row on GPIO20, and sends the result on SCI-C at GPIO63
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

SENDER = """
          .include "f28335.inc"
          .reserve ".stack", 0x400, 0x300
          .sect ".text", 0x9000
          .global _delay
_c_int00: MOV   @SP,#0x400
          LCR   #_start_chip
          EALLOW
          MOVW  DP,#GPAMUX2 >> 6
          OR    @GPAMUX2+1,#0x0500  ; GPIO28 SCIRXDA, GPIO29 SCITXDA
          EDIS
          MOVW  DP,#SCICCR >> 6
          MOV   @SCICCR,#7
          MOV   @SCIHBAUD,#487 >> 8 ; 37.5 MHz / 8 / 9600 - 1
          MOV   @SCILBAUD,#487 & 0xFF
          MOV   @SCICTL1,#0x23
send:     MOVB  AL,#0x73
          MOV   @SCICCR+9,AL        ; SCITXBUF
          MOV   @AH,#PASSES >> 16
          MOV   @AL,#PASSES & 0xFFFF
          LCR   #_delay
          SB    send,UNC
_delay:   SUBB  ACC,#1
          BF    _delay,GEQ
          LRETR
          .include "start.inc"
"""

CLOCK = """
          .include "f28335.inc"
I2CFFTX   .set  0x7920
I2CFFRX   .set  0x7921
ARDY_CODE .set  3                   ; I2CISRC
SCD_CODE  .set  6
WRITES    .set  10
COUNT     .set  8
          .reserve ".stack", 0x400, 0x300
          .sect ".econst", 0x8000
          .global _writes, _got, _busy
_writes:  .word 0x3F, 0x02, 0x3F, 0x06                          ; WEL, then RWEL
          .word 0x37, 0x20, 0x35, 0x12, 0x34, 0x03, 0x33, 0x01  ; 2012-03-01, the 6th day, 15:39:50
          .word 0x36, 0x06, 0x32, 0x95, 0x31, 0x39, 0x30, 0x50
          .sect ".ebss", 0x8040
_got:     .space COUNT
_busy:    .word 0
          .sect ".text", 0x9000
          .global _i2c_int1a, _start, _wait
_c_int00: MOV   @SP,#0x400
          LCR   #_start_chip
          LCR   #_start_i2c
          MOV   @I2CSAR,#0x6F
          MOV   @I2CCLKL,#45        ; 10 MHz / (45 + 5 + 45 + 5)
          MOV   @I2CCLKH,#45
          MOV   @I2CMDR,#0x0020     ; IRS
          MOV   @I2CIER,#0x20       ; SCD
          MOVW  DP,#I2CFFTX >> 6
          MOV   @I2CFFTX,#0x6000
          MOV   @I2CFFRX,#0x2000
          EALLOW
          MOVL  XAR4,#_i2c_int1a
          MOVL  XAR5,#I2CINT1A
          MOVL  *XAR5,XAR4
          EDIS
          MOVW  DP,#PIECTRL >> 6
          MOV   @PIECTRL,#1
          MOV   @PIEIER8,#1
          OR    IER,#0x80
          CLRC  INTM
          MOVL  XAR4,#_writes
          MOVB  XAR0,#WRITES - 1
pair:     MOVB  XAR1,#3
          LCR   #_start
          MOV   AL,*XAR4++
          MOV   @I2CDXR,AL
          MOV   AL,*XAR4++
          MOV   @I2CDXR,AL
          MOV   @I2CMDR,#0x6E20     ; FREE, STT, STP, MST, TRX, IRS
          LCR   #_wait
          BANZ  pair,AR0--
          MOVB  XAR1,#2             ; the pointer; ARDY ends it, for there is no STOP
          LCR   #_start
          MOVB  AL,#0x30
          MOV   @I2CDXR,AL
          OR    @I2CIER,#4
          MOV   @I2CMDR,#0x6620     ; FREE, STT, MST, TRX, IRS
          LCR   #_wait
          MOVL  XAR4,#_got
          MOVB  XAR0,#COUNT - 1
take:     MOV   AL,@I2CDRR
          MOV   *XAR4++,AL
          BANZ  take,AR0--
          ESTOP0

; AR1 bytes, the first of them 0, the upper half of the register's address.
_start:   MOVW  DP,#_busy >> 6
          MOV   @_busy,#1
          MOVW  DP,#I2CMDR >> 6
free:     TBIT  @I2CMDR,#11         ; STP
          SB    free,TC
          MOV   @I2CCNT,AR1
          MOV   @I2CDXR,#0
          LRETR

_wait:    MOVW  DP,#_busy >> 6
again:    MOV   AL,@_busy
          SB    again,NEQ
          MOVW  DP,#I2CMDR >> 6
          LRETR

_i2c_int1a:
          ASP
          MOVW  DP,#I2CISRC >> 6
          MOV   AL,@I2CISRC
          ANDB  AL,#7
          CMPB  AL,#ARDY_CODE
          SB    over,NEQ
          AND   @I2CIER,#~4
          MOV   @I2CCNT,#COUNT
          MOV   @I2CMDR,#0x6C20     ; FREE, STT, STP, MST, IRS
          SB    done,UNC
over:     MOVW  DP,#_busy >> 6
          MOV   @_busy,#0
done:     MOVW  DP,#PIEACK >> 6
          MOV   @PIEACK,#0x80
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

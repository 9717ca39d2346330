; An interrupt-driven slave with registers, like firmware/python/register_slave.py: a master writes and reads them through
; a pointer.
;
;   S addr W  pointer  [data ...] P             writes registers, beginning at the pointer
;   S addr W  pointer  Sr addr R  data ... N P  reads registers, beginning at the pointer
;   S addr R  data ... N P                      reads registers, beginning after the last one transferred
;
; There are 256 registers, one byte in each word. 150 MHz from a crystal of 30 MHz.

          .include "f28335.inc"

ADDRESS   .set  0x50
NACK_CODE .set  2                 ; codes in I2CISRC
RRDY_CODE .set  4
XRDY_CODE .set  5
SCD_CODE  .set  6
AAS_CODE  .set  7

          .global _registers, _pointer, _pointer_comes, _for_all
          .reserve ".stack", 0x400, 0x300
          .sect ".ebss", 0x8000
_registers:     .word 0x10, 0x11, 0x12, 0x13
                .space 252
_pointer:       .word 0           ; the register that is transferred next
_pointer_comes: .word 0           ; 1: the next received byte is the pointer
_for_all:       .word 0           ; not 0: the present transfer is a general call

          .sect ".text", 0x9000
          .global _i2c_int1a, _send, _step, _start_pie

_c_int00: MOV   @SP,#0x400
          LCR   #_start_chip
          LCR   #_start_i2c
          MOV   @I2COAR,#ADDRESS
          OR    @I2CMDR,#1 << IRS
          MOV   @I2CIER,#0x6A     ; AAS, SCD, RRDY, NACK; XRDY is enabled only during a read
          LCR   #_start_pie
sleep:    IDLE
          SB    sleep,UNC

; I2CINT1A: handles interrupt codes until none is left. DP stays at the module's page.
_i2c_int1a:
          ASP
          PUSH  XAR4
          PUSH  XAR5
          MOVL  XAR5,#_pointer
          MOVW  DP,#I2CISRC >> 6
another:  MOV   AL,@I2CISRC
          ANDB  AL,#7
          SB    over,EQ
          CMPB  AL,#RRDY_CODE
          SB    came,EQ
          CMPB  AL,#XRDY_CODE
          SB    wanted,EQ
          CMPB  AL,#AAS_CODE
          SB    addressed,EQ
          CMPB  AL,#SCD_CODE
          SB    ended,EQ
          CMPB  AL,#NACK_CODE
          SB    another,NEQ
ended:    AND   @I2CIER,#~(1 << XRDY)
          SB    another,UNC

addressed:
          MOV   AL,@I2CSTR
          MOV   AH,@AL
          AND   AH,@AH,#1 << AD0
          MOV   *+XAR5[2],AH      ; _for_all
          TBIT  @AL,#SDIR
          SB    reads,TC
          AND   @I2CIER,#~(1 << XRDY)
          CMPB  AH,#0
          SB    another,NEQ
          MOVB  AL,#1
          MOV   *+XAR5[1],AL      ; _pointer_comes
          SB    another,UNC
reads:    CMPB  AH,#0
          SB    first,NEQ
          MOV   *+XAR5[1],#0
first:    LCR   #_send
          OR    @I2CIER,#1 << XRDY
          SB    another,UNC

wanted:   LCR   #_step
          LCR   #_send
          SB    another,UNC

came:     MOV   AL,@I2CDRR
          MOV   AH,*+XAR5[2]      ; the bytes of a general call are acknowledged, and ignored
          SB    another,NEQ
          MOV   AH,*+XAR5[1]
          SB    data,EQ
          MOV   *+XAR5[0],AL
          MOV   *+XAR5[1],#0
          SB    another,UNC
data:     MOVL  XAR4,#_registers
          MOVZ  AR0,*+XAR5[0]
          MOV   *+XAR4[AR0],AL
          LCR   #_step
          SB    another,UNC

over:     MOVW  DP,#PIEACK >> 6
          MOV   @PIEACK,#0x80     ; group 8
          POP   XAR5
          POP   XAR4
          NASP
          IRET

; Writes the register at the pointer to I2CDXR.
_send:    MOVL  XAR4,#_registers
          MOVZ  AR0,*+XAR5[0]
          MOV   AL,*+XAR4[AR0]
          MOV   @I2CDXR,AL
          LRETR

; Advances the pointer; the first register follows the last one.
_step:    MOV   AL,*+XAR5[0]
          ADDB  AL,#1
          ANDB  AL,#0xFF
          MOV   *+XAR5[0],AL
          LRETR

_start_pie:
          EALLOW
          MOVL  XAR4,#_i2c_int1a
          MOVL  XAR5,#I2CINT1A
          MOVL  *XAR5,XAR4
          EDIS
          MOVW  DP,#PIECTRL >> 6
          MOV   @PIECTRL,#1
          MOV   @PIEIER8,#1
          OR    IER,#0x80
          MOV   @PIEACK,#0xFFF
          CLRC  INTM
          LRETR

          .include "start.inc"

; An I2C master that stores eight bytes in an EEPROM with two-byte addresses, polls until they are stored, and reads them
; back. SYSCLKOUT: 150 MHz, crystal: 30 MHz, SCL: 100 kHz. The program ends at ESTOP0.

          .include "f28335.inc"

ADDRESS   .set  0x50
WORD      .set  0x0038            ; eight bytes before the end of a page of 32
COUNT     .set  8

          .global _record, _got
          .reserve ".stack", 0x400, 0x300
          .sect ".econst", 0x8000
_record:  .word WORD >> 8, WORD & 0xFF
          .word 0xA0, 0xA1, 0xA2, 0xA3, 0xA4, 0xA5, 0xA6, 0xA7
          .sect ".ebss", 0x8040
_got:     .space COUNT

          .sect ".text", 0x9000

_c_int00: MOV   @SP,#0x400
          LCR   #_start_chip
          LCR   #_start_i2c
          LCR   #_start_master
          MOVB  XAR1,#ADDRESS
          MOVL  XAR4,#_record
          MOVB  XAR0,#2 + COUNT
          LCR   #_send
          OR    @I2CMDR,#1 << STP
stored:   MOVL  XAR4,#_record     ; the EEPROM does not acknowledge its address while it stores data
          MOVB  XAR0,#2
          LCR   #_send
          SB    stored,TC
          MOVL  XAR4,#_got
          MOVB  XAR0,#COUNT
          LCR   #_receive
          LCR   #_idle_bus
          ESTOP0

          .include "master.inc"
          .include "start.inc"

; An I2C master that sets a real-time clock like the ISL12026 (address 0x6F, two-byte register addresses): it sets the
; write enable bits of the status register, writes the eight time registers, and reads them back. SCL: 100 kHz.

          .include "f28335.inc"

ADDRESS   .set  0x6F
COUNT     .set  8

          .global _enable, _unlock, _time, _got
          .reserve ".stack", 0x400, 0x300
          .sect ".econst", 0x8000
_enable:  .word 0x00, 0x3F, 0x02  ; WEL
_unlock:  .word 0x00, 0x3F, 0x06  ; RWEL and WEL
_time:    .word 0x00, 0x30        ; from the register of the seconds on
          .word 0x50, 0x39, 0x95, 0x01, 0x03, 0x12, 0x06, 0x20  ; 15:39:50 in 24-hour format, 2012-03-01, day 6
          .sect ".ebss", 0x8040
_got:     .space COUNT

          .sect ".text", 0x9000
          .global _write

_c_int00: MOV   @SP,#0x400
          LCR   #_start_chip
          LCR   #_start_i2c
          LCR   #_start_master
          MOVB  XAR1,#ADDRESS
          MOVL  XAR4,#_enable
          MOVB  XAR0,#3
          LCR   #_write
          MOVL  XAR4,#_unlock
          MOVB  XAR0,#3
          LCR   #_write
          MOVL  XAR4,#_time
          MOVB  XAR0,#2 + COUNT
          LCR   #_write
          MOVL  XAR4,#_time
          MOVB  XAR0,#2
          LCR   #_send
          MOVL  XAR4,#_got
          MOVB  XAR0,#COUNT
          LCR   #_receive
          LCR   #_idle_bus
          ESTOP0

; Sends AR0 bytes from XAR4 on, and a STOP.
_write:   LCR   #_send
          OR    @I2CMDR,#1 << STP
          LRETR

          .include "master.inc"
          .include "start.inc"

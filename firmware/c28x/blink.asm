; Timer 0 toggles an LED on GPIO31 every 500 us. In between, the CPU sleeps. SYSCLKOUT: 150 MHz, crystal: 30 MHz.

          .include "f28335.inc"

PERIOD    .set  75000             ; cycles: 500 us
LED       .set  1 << 31 - 16      ; GPIO31 in the upper word of port A

          .reserve ".stack", 0x400, 0x300
          .sect ".text", 0x9000
          .global _toggle

_c_int00: MOV   @SP,#0x400
          LCR   #_start_chip
          EALLOW
          MOVW  DP,#GPADIR >> 6
          OR    @GPADIR+1,#LED
          MOVL  XAR4,#_toggle
          MOVL  XAR5,#TINT0
          MOVL  *XAR5,XAR4
          EDIS
          MOVW  DP,#TIMER0PRD >> 6
          MOVL  XAR4,#PERIOD - 1
          MOVL  @TIMER0PRD,XAR4
          MOV   @TIMER0TCR,#0x4020  ; TIE, TRB
          MOVW  DP,#PIECTRL >> 6
          MOV   @PIECTRL,#1
          MOV   @PIEIER1,#0x40    ; line 7
          OR    IER,#1
          MOV   @PIEACK,#0xFFF
          CLRC  INTM
sleep:    IDLE
          SB    sleep,UNC

_toggle:  MOVW  DP,#GPATOGGLE >> 6
          MOV   @GPATOGGLE+1,#LED
          MOVW  DP,#PIEACK >> 6
          MOV   @PIEACK,#1        ; group 1
          IRET

          .include "start.inc"

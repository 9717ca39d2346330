; SCI-A echo: each character received on GPIO28 is sent on GPIO29. 115200 8N1; SYSCLKOUT: 150 MHz, crystal: 30 MHz.
; periph-sim assemble firmware/c28x/sci_echo.asm sci_echo.out

PLLSTS    .set  0x7011            ; system control: page 0x7000
LOSPCP    .set  0x701B
PCLKCR0   .set  0x701C
PLLCR     .set  0x7021
WDCR      .set  0x7029
GPAQSEL2  .set  0x6F84            ; GPIO: pages 0x6F80 and 0x6FC0
GPAMUX2   .set  0x6F88
SCICCR    .set  0x7050            ; SCI-A: page 0x7040
SCICTL1   .set  0x7051
SCIHBAUD  .set  0x7052
SCILBAUD  .set  0x7053
SCICTL2   .set  0x7054
SCIRXST   .set  0x7055
SCIRXBUF  .set  0x7057
SCITXBUF  .set  0x7059

PLLLOCKS  .set  0                 ; bits
RXRDY     .set  6
TXRDY     .set  7

BRR       .set  40                ; 37.5 MHz / 8 / 115200 - 1, rounded

          .global _start_sci, _echo
          .sect ".text", 0x9000
          .reserve ".stack", 0x400, 0x300

_c_int00: MOV   @SP,#0x400
          EALLOW
          MOVW  DP,#WDCR >> 6
          MOV   @WDCR,#0x68       ; watchdog off
          AND   @PLLSTS,#0xFE7F   ; DIVSEL = 0 before PLLCR changes
          OR    @PLLSTS,#0x40     ; MCLKOFF
          MOV   @PLLCR,#10
lock:     TBIT  @PLLSTS,#PLLLOCKS
          SB    lock,NTC
          AND   @PLLSTS,#0xFFBF
          OR    @PLLSTS,#0x100    ; DIVSEL = 2: 30 MHz * 10 / 2
          MOV   @LOSPCP,#2        ; LSPCLK = 37.5 MHz
          OR    @PCLKCR0,#0x400   ; SCIAENCLK
          MOVW  DP,#GPAMUX2 >> 6
          OR    @GPAQSEL2+1,#0x300
          OR    @GPAMUX2+1,#0x500
          EDIS
          LCR   #_start_sci

_echo:    MOVW  DP,#SCICCR >> 6
wait:     TBIT  @SCIRXST,#RXRDY
          SB    wait,NTC
          MOV   AL,@SCIRXBUF
send:     TBIT  @SCICTL2,#TXRDY
          SB    send,NTC
          MOV   @SCITXBUF,AL
          SB    wait,UNC

_start_sci:
          MOVW  DP,#SCICCR >> 6
          MOV   @SCICCR,#0x07     ; 8 data bits, no parity, one stop bit
          MOV   @SCICTL1,#0x03
          MOV   @SCICTL2,#0
          MOV   @SCIHBAUD,#BRR >> 8
          MOV   @SCILBAUD,#BRR & 0xFF
          MOV   @SCICTL1,#0x23    ; SW RESET released
          LRETR

; The IMU emulator of firmware/python/imu_hil.py in assembly: it receives host frames by SCI and emulates three chips on I2C.
;
;   SCI FIFO interrupt --> frame --> models (GPIO34 high to low) --> bytes of three chips
;   request of the sensor head --> own address, pointer byte, SDIR, I2CDXR/XRDY, SCD
;
; The chips show values of the frame, like imu_hil.py with arithmetic = "bytes". A frame has six signed 16-bit values,
; low byte first. The gyroscope shows the angles, high byte first; the accelerometer the accelerations, low byte first; the
; magnetometer the angles, high byte first, z before y. 150 MHz from a crystal of 30 MHz; code and data are in RAM.

          .include "f28335.inc"

GYROSCOPE     .set 0x68           ; addresses, in the order in which they are read
ACCELEROMETER .set 0x53
MAGNETOMETER  .set 0x1E
COUNT         .set 6              ; number of bytes in a read
FRAME_BYTES   .set 12
BRR           .set 40             ; 37.5 MHz / 8 / 115200 - 1, rounded
MODEL_PIN     .set 1 << 34 - 32   ; GPIO34 in the registers of port B

          .global _frame, _taken, _gyroscope, _accelerometer, _magnetometer, _order
          .reserve ".stack", 0x400, 0x300
          .sect ".ebss", 0x8000
_frame:   .space FRAME_BYTES      ; the last frame, one byte in each word
_taken:   .space FRAME_BYTES      ; the frame with which the models work
_gyroscope:     .space 8          ; the bytes that each chip sends, followed by zeros
_accelerometer: .space 8
_magnetometer:  .space 8

          .sect ".econst", 0x8040
_order:   .word 1, 0, 3, 2, 5, 4  ; index in the frame of each byte of the gyroscope,
          .word 6, 7, 8, 9, 10, 11  ; of each byte of the accelerometer,
          .word 1, 0, 5, 4, 3, 2    ; and of each byte of the magnetometer

          .sect ".text", 0x9000
          .global _main, _serve, _model, _six_bytes, _sci_received, _start_sci, _start_pin, _start_pie

_c_int00: MOV   @SP,#0x400
          LCR   #_start_chip
          LCR   #_start_pin
          LCR   #_start_i2c
          LCR   #_start_sci
          LCR   #_start_pie

_main:    LCR   #_model
          MOVB  AL,#GYROSCOPE
          MOVL  XAR4,#_gyroscope
          LCR   #_serve
          MOVB  AL,#ACCELEROMETER
          MOVL  XAR4,#_accelerometer
          LCR   #_serve
          MOVB  AL,#MAGNETOMETER
          MOVL  XAR4,#_magnetometer
          LCR   #_serve
          SB    _main,UNC

; Serves one read of the sensor head. AL: the chip's address. XAR4: its bytes. The steps are I2C_SLAVE_CONFIG and
; i2cBatchRead of the dissertation (Figs. A.2, A.4): each assignment to a field reads and writes the whole register.
_serve:   MOVW  DP,#I2CMDR >> 6
          AND   @I2CMDR,#~(1 << IRS)
          AND   @I2CMDR,#~(1 << MST)
          MOV   @I2COAR,AL
          OR    @I2CMDR,#1 << IRS
asked:    TBIT  @I2CSTR,#AAS
          SB    asked,NTC
          MOV   @I2CCNT,#1
pointer:  TBIT  @I2CSTR,#RRDY
          SB    pointer,NTC
          OR    @I2CMDR,#1 << TRX
          MOV   @I2CCNT,#COUNT
          OR    @I2CSTR,#1 << SCD
read:     TBIT  @I2CSTR,#SDIR     ; workaround: no byte is written before the module is slave-transmitter
          SB    read,NTC
next:     MOV   AL,*XAR4++
          MOV   @I2CDXR,AL
wanted:   TBIT  @I2CSTR,#XRDY
          SB    next,TC
          TBIT  @I2CSTR,#SCD
          SB    wanted,NTC
          OR    @I2CMDR,#1 << IRS
          LRETR

; The models: put the bytes of the last frame in each chip's order. RPT is not interrupted, so the frame is consistent.
_model:   MOVW  DP,#GPBSET >> 6
          MOV   @GPBSET,#MODEL_PIN
          MOVL  XAR7,#_frame
          MOVL  XAR6,#_taken
          RPT   #FRAME_BYTES - 1 || PREAD *XAR6++,*XAR7
          MOVL  XAR4,#_taken
          MOVL  XAR5,#_order
          MOVL  XAR6,#_gyroscope
          LCR   #_six_bytes
          MOVL  XAR6,#_accelerometer
          LCR   #_six_bytes
          MOVL  XAR6,#_magnetometer
          LCR   #_six_bytes
          MOV   @GPBCLEAR,#MODEL_PIN
          LRETR

; *XAR6++ = XAR4[*XAR5++], six times.
_six_bytes:
          MOVB  XAR7,#5
each:     MOVZ  AR0,*XAR5++
          MOV   AL,*+XAR4[AR0]
          MOV   *XAR6++,AL
          BANZ  each,AR7--
          LRETR

; SCIRXINTA: the FIFO holds a complete frame.
_sci_received:
          ASP
          PUSH  XAR4
          MOVL  XAR4,#_frame
          MOVW  DP,#SCIRXBUF >> 6
          MOV   @AR0,#FRAME_BYTES - 1
take:     MOV   AL,@SCIRXBUF
          ANDB  AL,#0xFF
          MOV   *XAR4++,AL
          BANZ  take,AR0--
          OR    @SCIFFRX,#0x4000  ; RXFFOVRCLR
          OR    @SCIFFRX,#0x0040  ; RXFFINTCLR
          MOVW  DP,#PIEACK >> 6
          MOV   @PIEACK,#0x100    ; group 9
          POP   XAR4
          NASP
          IRET

_start_pin:                       ; makes GPIO34 (MODEL_PIN) an output at level 0
          MOVW  DP,#GPBCLEAR >> 6
          MOV   @GPBCLEAR,#MODEL_PIN
          EALLOW
          MOVW  DP,#GPBDIR >> 6
          OR    @GPBDIR,#MODEL_PIN
          EDIS
          LRETR

_start_sci:                       ; sets up GPIO28, GPIO29, and a receive FIFO that interrupts at a complete frame
          EALLOW
          MOVW  DP,#GPAMUX2 >> 6
          OR    @GPAQSEL2+1,#0x300
          OR    @GPAMUX2+1,#0x500
          EDIS
          MOVW  DP,#SCICCR >> 6
          MOV   @SCICCR,#0x07     ; 8 data bits, no parity, one stop bit
          MOV   @SCICTL1,#0x03
          MOV   @SCICTL2,#0
          MOV   @SCIHBAUD,#BRR >> 8
          MOV   @SCILBAUD,#BRR & 0xFF
          MOV   @SCIFFTX,#0xC000  ; SCIRST, SCIFFENA
          MOV   @SCIFFRX,#0       ; FIFO held in reset
          MOV   @SCIFFRX,#0x6060 | FRAME_BYTES
          MOV   @SCICTL1,#0x23    ; SW RESET released
          LRETR

_start_pie:
          EALLOW
          MOVL  XAR4,#_sci_received
          MOVL  XAR5,#SCIRXINTA
          MOVL  *XAR5,XAR4
          EDIS
          MOVW  DP,#PIECTRL >> 6
          MOV   @PIECTRL,#1
          MOV   @PIEIER9,#1
          OR    IER,#0x100
          MOV   @PIEACK,#0xFFF
          CLRC  INTM
          LRETR

          .include "start.inc"

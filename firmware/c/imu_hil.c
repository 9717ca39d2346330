/* The IMU emulator of firmware/python/imu_hil.py in C: it receives host frames by SCI and emulates three chips on I2C.
 *
 *   SCI FIFO interrupt --> frame --> models (GPIO34 high to low) --> bytes of three chips
 *   request of the sensor head --> own address, pointer byte, SDIR, I2CDXR/XRDY, SCD
 *
 * The chips show the values of the frame, as in the Python firmware with arithmetic = "bytes". A frame has six signed
 * 16-bit values, low byte first. The gyroscope shows the angles, high byte first; the accelerometer the accelerations, low
 * byte first; the magnetometer the angles, high byte first, z before y. SYSCLKOUT: 150 MHz from a crystal of 30 MHz. */

#include "f28335.h"

enum { GYROSCOPE = 0x68, ACCELEROMETER = 0x53, MAGNETOMETER = 0x1E }; /* addresses */
enum { COUNT = 6, FRAME_BYTES = 12 };
enum { BRR = 40 }; /* 37.5 MHz / 8 / 115200 - 1, rounded */
#define MODEL_PIN (1ul << (34 - 32)) /* GPIO34 in the registers of port B */

static volatile uint16_t frame[FRAME_BYTES]; /* the last frame, one byte in each element */
static uint16_t gyroscope[COUNT + 2], accelerometer[COUNT + 2], magnetometer[COUNT + 2]; /* zeros follow the bytes */
static const uint16_t gyroscope_order[COUNT] = {1, 0, 3, 2, 5, 4}; /* index in the frame of each byte of the chip */
static const uint16_t accelerometer_order[COUNT] = {6, 7, 8, 9, 10, 11};
static const uint16_t magnetometer_order[COUNT] = {1, 0, 5, 4, 3, 2};

/* SCIRXINTA: the FIFO holds a complete frame. */
interrupt void sci_received(void)
{
    int i;
    for (i = 0; i < FRAME_BYTES; i++)
        frame[i] = SciaRegs.SCIRXBUF & 0xFF;
    SciaRegs.SCIFFRX.bit.RXFFOVRCLR = 1;
    SciaRegs.SCIFFRX.bit.RXFFINTCLR = 1;
    PieCtrlRegs.PIEACK = 0x100; /* group 9 */
}

static void show(uint16_t *bytes, const uint16_t *order, const uint16_t *taken)
{
    int i;
    for (i = 0; i < COUNT; i++)
        bytes[i] = taken[order[i]];
}

static void model(void)
{
    uint16_t taken[FRAME_BYTES];
    int i;
    GpioDataRegs.B.SET = MODEL_PIN;
    asm(" SETC INTM"); /* no byte of the frame changes during the copy */
    for (i = 0; i < FRAME_BYTES; i++)
        taken[i] = frame[i];
    asm(" CLRC INTM");
    show(gyroscope, gyroscope_order, taken);
    show(accelerometer, accelerometer_order, taken);
    show(magnetometer, magnetometer_order, taken);
    GpioDataRegs.B.CLEAR = MODEL_PIN;
}

/* I2C_SLAVE_CONFIG of the dissertation (Fig. A.2): sets the own address. */
static void slave_config(uint16_t address)
{
    I2caRegs.I2CMDR.bit.IRS = 0;
    I2caRegs.I2CMDR.bit.MST = 0;
    I2caRegs.I2COAR = address;
    I2caRegs.I2CMDR.bit.IRS = 1;
}

/* Waits for the end of the transfer (returns 0), or until the transmitter needs a byte (returns 1). */
static int wants_byte(void)
{
    for (;;) {
        if (I2caRegs.I2CSTR.bit.XRDY == 1)
            return 1;
        if (I2caRegs.I2CSTR.bit.SCD == 1)
            return 0;
    }
}

/* i2cBatchRead of the dissertation (Fig. A.4): serves one read of the sensor head. */
static void batch_read(const uint16_t *bytes)
{
    while (I2caRegs.I2CSTR.bit.AAS == 0)
        ;
    I2caRegs.I2CCNT = 1;
    while (I2caRegs.I2CSTR.bit.RRDY == 0) /* the pointer byte */
        ;
    I2caRegs.I2CMDR.bit.TRX = 1;
    I2caRegs.I2CCNT = COUNT;
    I2caRegs.I2CSTR.bit.SCD = 1;
    while (I2caRegs.I2CSTR.bit.SDIR == 0) /* workaround: no byte is written before the module is slave-transmitter */
        ;
    do
        I2caRegs.I2CDXR = *bytes++;
    while (wants_byte());
    I2caRegs.I2CMDR.bit.IRS = 1;
}

/* Switches the watchdog off, and sets up PLL and module clocks. */
static void start_chip(void)
{
    EALLOW;
    SysCtrlRegs.WDCR = 0x68;
    SysCtrlRegs.PLLSTS.bit.DIVSEL = 0; /* before PLLCR changes */
    SysCtrlRegs.PLLSTS.bit.MCLKOFF = 1;
    SysCtrlRegs.PLLCR = 10;
    while (SysCtrlRegs.PLLSTS.bit.PLLLOCKS == 0)
        ;
    SysCtrlRegs.PLLSTS.bit.MCLKOFF = 0;
    SysCtrlRegs.PLLSTS.bit.DIVSEL = 2; /* 30 MHz * 10 / 2 */
    SysCtrlRegs.LOSPCP = 2;            /* LSPCLK = 37.5 MHz */
    SysCtrlRegs.PCLKCR0.bit.SCIAENCLK = 1;
    SysCtrlRegs.PCLKCR0.bit.I2CAENCLK = 1;
    EDIS;
}

static void start_pins(void)
{
    GpioDataRegs.B.CLEAR = MODEL_PIN;
    EALLOW;
    GpioCtrlRegs.B.DIR |= MODEL_PIN;
    GpioCtrlRegs.A.QSEL2.bit.PIN12 = 3; /* GPIO28: SCIRXDA, asynchronous */
    GpioCtrlRegs.A.MUX2.bit.PIN12 = 1;
    GpioCtrlRegs.A.MUX2.bit.PIN13 = 1; /* GPIO29: SCITXDA */
    GpioCtrlRegs.B.QSEL1.bit.PIN0 = 3; /* GPIO32: SDAA, GPIO33: SCLA */
    GpioCtrlRegs.B.QSEL1.bit.PIN1 = 3;
    GpioCtrlRegs.B.MUX1.bit.PIN0 = 1;
    GpioCtrlRegs.B.MUX1.bit.PIN1 = 1;
    EDIS;
}

/* Sets a module clock of 10 MHz. The module stays in reset. */
static void start_i2c(void)
{
    I2caRegs.I2CMDR.all = 0;
    I2caRegs.I2COAR = 0;
    I2caRegs.I2CPSC = 14;
    I2caRegs.I2CCLKL = 10;
    I2caRegs.I2CCLKH = 5;
}

/* Sets up the receive FIFO, with an interrupt when it holds a complete frame. */
static void start_sci(void)
{
    SciaRegs.SCICCR = 0x07; /* 8 data bits, no parity, one stop bit */
    SciaRegs.SCICTL1 = 0x03;
    SciaRegs.SCICTL2 = 0;
    SciaRegs.SCIHBAUD = BRR >> 8;
    SciaRegs.SCILBAUD = BRR & 0xFF;
    SciaRegs.SCIFFTX = 0xC000;  /* SCIRST, SCIFFENA */
    SciaRegs.SCIFFRX.all = 0;   /* FIFO held in reset */
    SciaRegs.SCIFFRX.all = 0x6060 | FRAME_BYTES;
    SciaRegs.SCICTL1 = 0x23; /* SW RESET released; receiver and transmitter enabled */
}

static void start_pie(void)
{
    EALLOW;
    PieVectTable.group[9 - 1][0] = &sci_received;
    EDIS;
    PieCtrlRegs.PIECTRL = 1;
    PieCtrlRegs.group[9 - 1].PIEIER = 1;
    IER |= 0x100;
    PieCtrlRegs.PIEACK = 0xFFF;
    EINT;
}

int main(void)
{
    start_chip();
    start_pins();
    start_i2c();
    start_sci();
    start_pie();
    for (;;) {
        model();
        slave_config(GYROSCOPE);
        batch_read(gyroscope);
        slave_config(ACCELEROMETER);
        batch_read(accelerometer);
        slave_config(MAGNETOMETER);
        batch_read(magnetometer);
    }
}

/* SCI-A echo by interrupt, 115200 8N1 at 150 MHz; GPIO31 toggles with each character. */
#include "device.h"

#ifndef FIRST
#define FIRST 0
#endif

volatile int received;

interrupt void character(void) {
    SciaRegs.SCITXBUF = SciaRegs.SCIRXBUF + FIRST;
    GpioDataRegs.GPATOGGLE.bit.GPIO31 = 1;
    received++;
    PieCtrlRegs.PIEACK = 0x100;
}

static void clocks(void) {
    EALLOW;
    SysCtrlRegs.WDCR = 0x68;
    SysCtrlRegs.PLLSTS.bit.DIVSEL = 0;
    SysCtrlRegs.PLLSTS.bit.MCLKOFF = 1;
    SysCtrlRegs.PLLCR = 10;
    while (SysCtrlRegs.PLLSTS.bit.PLLLOCKS == 0)
        ;
    SysCtrlRegs.PLLSTS.bit.MCLKOFF = 0;
    SysCtrlRegs.PLLSTS.bit.DIVSEL = 2;
    SysCtrlRegs.LOSPCP = 2;
    SysCtrlRegs.PCLKCR0 |= 0x400;
    GpioCtrlRegs.GPAMUX2 |= 0x05000000;
    GpioCtrlRegs.GPADIR = 0x80000000;
    EDIS;
}

int main(void) {
    DINT;
    clocks();
    SciaRegs.SCICCR = 7;
    SciaRegs.SCICTL1 = 3;
    SciaRegs.SCIHBAUD = 0;
    SciaRegs.SCILBAUD = 40;
    SciaRegs.SCICTL2.bit.RXBKINTENA = 1;
    SciaRegs.SCICTL1 = 0x23;
    EALLOW;
    PieVectTable.group9[0] = &character;
    EDIS;
    PieCtrlRegs.PIECTRL = 1;
    ((volatile Uint16 *)&PieCtrlRegs)[2 + 2 * 8] = 1;
    IER |= 0x100;
    EINT;
    for (;;)
        ;
}

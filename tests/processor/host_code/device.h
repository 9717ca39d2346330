/* The registers that the tests need, with the layout of headers for this chip: a word is an `unsigned int`. */
#ifndef DEVICE_H
#define DEVICE_H
typedef unsigned int Uint16;
typedef unsigned long Uint32;

struct SCICTL2_BITS { Uint16 TXINTENA : 1; Uint16 RXBKINTENA : 1; Uint16 rsvd : 4; Uint16 TXEMPTY : 1; Uint16 TXRDY : 1; Uint16 rsvd2 : 8; };
union SCICTL2_REG { Uint16 all; struct SCICTL2_BITS bit; };
struct SCIRXST_BITS { Uint16 rsvd : 1; Uint16 RXWAKE : 1; Uint16 PE : 1; Uint16 OE : 1; Uint16 FE : 1; Uint16 BRKDT : 1; Uint16 RXRDY : 1; Uint16 RXERROR : 1; };
union SCIRXST_REG { Uint16 all; struct SCIRXST_BITS bit; };
struct SCI_REGS {
    Uint16 SCICCR, SCICTL1, SCIHBAUD, SCILBAUD;
    union SCICTL2_REG SCICTL2;
    union SCIRXST_REG SCIRXST;
    Uint16 SCIRXEMU, SCIRXBUF, rsvd1, SCITXBUF, SCIFFTX, SCIFFRX, SCIFFCT, rsvd2[2], SCIPRI;
};
extern volatile struct SCI_REGS SciaRegs;

union PLLSTS_REG { Uint16 all; struct { Uint16 PLLLOCKS : 1; Uint16 rsvd : 1; Uint16 PLLOFF : 1; Uint16 MCLKSTS : 1; Uint16 MCLKCLR : 1; Uint16 OSCOFF : 1; Uint16 MCLKOFF : 1; Uint16 DIVSEL : 2; } bit; };
struct SYS_CTRL_REGS {
    Uint16 rsvd0; union PLLSTS_REG PLLSTS; Uint16 rsvd1[8], HISPCP, LOSPCP, PCLKCR0, PCLKCR1, LPMCR0, rsvd2, PCLKCR3, PLLCR, SCSR, WDCNTR, rsvd3, WDKEY, rsvd4[3], WDCR;
};
extern volatile struct SYS_CTRL_REGS SysCtrlRegs;

struct GPBMUX_BITS { Uint16 low : 2; };
struct GPIO_CTRL_REGS { Uint32 GPACTRL, GPAQSEL1, GPAQSEL2, GPAMUX1, GPAMUX2, GPADIR; };
extern volatile struct GPIO_CTRL_REGS GpioCtrlRegs;
struct GPADAT_BITS { Uint16 low : 16; Uint16 high : 15; Uint16 GPIO31 : 1; };
union GPADAT_REG { Uint32 all; struct GPADAT_BITS bit; };
struct GPIO_DATA_REGS { union GPADAT_REG GPADAT, GPASET, GPACLEAR, GPATOGGLE; };
extern volatile struct GPIO_DATA_REGS GpioDataRegs;

struct PIE_CTRL_REGS { Uint16 PIECTRL, PIEACK, PIEIER1, PIEIFR1; Uint16 others[14]; Uint16 rest[6]; };
extern volatile struct PIE_CTRL_REGS PieCtrlRegs;
typedef interrupt void (*PINT)(void);
struct PIE_VECT_TABLE { PINT first[32]; PINT group1[8]; PINT other[56]; PINT group9[8]; };
extern struct PIE_VECT_TABLE PieVectTable;
extern cregister volatile unsigned int IER, IFR;
extern void DSP28x_usDelay(Uint32);
#define EINT asm(" clrc INTM")
#define DINT asm(" setc INTM")
#define EALLOW asm(" EALLOW")
#define EDIS asm(" EDIS")
#endif

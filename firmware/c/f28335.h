/* The registers of the F28335 that imu_hil.c uses, with their names in the manuals.
 *
 * Sources: SPRUG03B (I2C), SPRUFZ5A (SCI), SPRUFB0D (system control, interrupts, GPIO), SPRS439M Tables 3-8 to 3-11. */

#ifndef F28335_H
#define F28335_H

#include <stdint.h>

struct I2CSTR_BITS {
    uint16_t AL : 1;
    uint16_t NACK : 1;
    uint16_t ARDY : 1;
    uint16_t RRDY : 1;
    uint16_t XRDY : 1;
    uint16_t SCD : 1;
    uint16_t reserved6 : 2;
    uint16_t AD0 : 1;
    uint16_t AAS : 1;
    uint16_t XSMT : 1;
    uint16_t RSFULL : 1;
    uint16_t BB : 1;
    uint16_t NACKSNT : 1;
    uint16_t SDIR : 1;
    uint16_t reserved15 : 1;
};

struct I2CMDR_BITS {
    uint16_t BC : 3;
    uint16_t FDF : 1;
    uint16_t STB : 1;
    uint16_t IRS : 1;
    uint16_t DLB : 1;
    uint16_t RM : 1;
    uint16_t XA : 1;
    uint16_t TRX : 1;
    uint16_t MST : 1;
    uint16_t STP : 1;
    uint16_t reserved12 : 1;
    uint16_t STT : 1;
    uint16_t FREE : 1;
    uint16_t NACKMOD : 1;
};

struct I2C_REGS {
    uint16_t I2COAR, I2CIER;
    union {
        uint16_t all;
        struct I2CSTR_BITS bit;
    } I2CSTR;
    uint16_t I2CCLKL, I2CCLKH, I2CCNT, I2CDRR, I2CSAR, I2CDXR;
    union {
        uint16_t all;
        struct I2CMDR_BITS bit;
    } I2CMDR;
    uint16_t I2CISRC, I2CEMDR, I2CPSC;
};

struct SCIFFRX_BITS {
    uint16_t RXFFIL : 5;
    uint16_t RXFFIENA : 1;
    uint16_t RXFFINTCLR : 1;
    uint16_t RXFFINT : 1;
    uint16_t RXFFST : 5;
    uint16_t RXFIFORESET : 1;
    uint16_t RXFFOVRCLR : 1;
    uint16_t RXFFOVF : 1;
};

struct SCI_REGS {
    uint16_t SCICCR, SCICTL1, SCIHBAUD, SCILBAUD, SCICTL2, SCIRXST, SCIRXEMU, SCIRXBUF, reserved8, SCITXBUF, SCIFFTX;
    union {
        uint16_t all;
        struct SCIFFRX_BITS bit;
    } SCIFFRX;
    uint16_t SCIFFCT;
};

struct PLLSTS_BITS {
    uint16_t PLLLOCKS : 1;
    uint16_t reserved1 : 1;
    uint16_t PLLOFF : 1;
    uint16_t MCLKSTS : 1;
    uint16_t MCLKCLR : 1;
    uint16_t OSCOFF : 1;
    uint16_t MCLKOFF : 1;
    uint16_t DIVSEL : 2;
    uint16_t reserved9 : 7;
};

struct PCLKCR0_BITS {
    uint16_t reserved0 : 4;
    uint16_t I2CAENCLK : 1;
    uint16_t reserved5 : 5;
    uint16_t SCIAENCLK : 1;
    uint16_t reserved11 : 5;
};

struct SYS_CTRL_REGS { /* from 0x7010 on */
    uint16_t reserved0;
    union {
        uint16_t all;
        struct PLLSTS_BITS bit;
    } PLLSTS;
    uint16_t reserved2[9], LOSPCP;
    union {
        uint16_t all;
        struct PCLKCR0_BITS bit;
    } PCLKCR0;
    uint16_t reserved13[4], PLLCR, reserved18[7], WDCR;
};

struct PIE_CTRL_REGS {
    uint16_t PIECTRL, PIEACK;
    struct {
        uint16_t PIEIER, PIEIFR;
    } group[12]; /* from group 1 on */
};

typedef void (*vector_t)(void);
struct PIE_VECT_TABLE {
    vector_t cpu[32];
    vector_t group[12][8]; /* from INT1.1 on */
};

struct PORT_PINS { /* two bits for each of 16 pins */
    uint32_t PIN0 : 2;
    uint32_t PIN1 : 2;
    uint32_t PIN2 : 2;
    uint32_t PIN3 : 2;
    uint32_t PIN4 : 2;
    uint32_t PIN5 : 2;
    uint32_t PIN6 : 2;
    uint32_t PIN7 : 2;
    uint32_t PIN8 : 2;
    uint32_t PIN9 : 2;
    uint32_t PIN10 : 2;
    uint32_t PIN11 : 2;
    uint32_t PIN12 : 2;
    uint32_t PIN13 : 2;
    uint32_t PIN14 : 2;
    uint32_t PIN15 : 2;
};

union PORT_PINS_REG {
    uint32_t all;
    struct PORT_PINS bit;
};

struct GPIO_PORT {
    uint32_t CTRL;
    union PORT_PINS_REG QSEL1, QSEL2, MUX1, MUX2;
    uint32_t DIR, PUD, reserved14;
};

struct GPIO_CTRL_REGS {
    struct GPIO_PORT A, B;
};

struct GPIO_DATA_REGS {
    struct {
        uint32_t DAT, SET, CLEAR, TOGGLE;
    } A, B;
};

extern volatile struct I2C_REGS I2caRegs;
extern volatile struct SCI_REGS SciaRegs;
extern volatile struct SYS_CTRL_REGS SysCtrlRegs;
extern volatile struct PIE_CTRL_REGS PieCtrlRegs;
extern volatile struct PIE_VECT_TABLE PieVectTable;
extern volatile struct GPIO_CTRL_REGS GpioCtrlRegs;
extern volatile struct GPIO_DATA_REGS GpioDataRegs;
extern cregister volatile unsigned int IER;

#define EALLOW asm(" EALLOW")
#define EDIS asm(" EDIS")
#define EINT asm(" CLRC INTM")

#endif

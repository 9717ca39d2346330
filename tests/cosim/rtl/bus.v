// An I2C bus with a pull-up, and a serial line: whoever writes 0 pulls, whoever writes 1 lets go.
`timescale 1ns / 1ps
module bus;
    reg dsp_scl = 1, dsp_sda = 1, other_scl = 1, other_sda = 1, third_scl = 1, third_sda = 1, rx = 1, tx = 1;
    tri1 scl, sda;
    assign scl = dsp_scl ? 1'bz : 1'b0;
    assign sda = dsp_sda ? 1'bz : 1'b0;
    assign scl = other_scl ? 1'bz : 1'b0;
    assign sda = other_sda ? 1'bz : 1'b0;
    assign scl = third_scl ? 1'bz : 1'b0;
    assign sda = third_sda ? 1'bz : 1'b0;
endmodule

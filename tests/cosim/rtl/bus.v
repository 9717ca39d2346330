// An I2C bus with pull-ups and a serial line. On the bus: the simulated part (dsp), a model of the test bench (other),
// two masters and a slave in logic. A party that writes 0 drives the line low, and one that writes 1 releases it. The
// clock runs while `run` is 1.
`timescale 1ns / 1ps
module bus;
    reg [31:0] period_ps = 20000;  // of the clock: 50 MHz
    reg [15:0] quarter = 125;  // of a bit, in cycles
    reg zero_hold = 0;
    reg dsp_scl = 1, dsp_sda = 1, other_scl = 1, other_sda = 1, rx = 1, tx = 1;
    reg run = 0, clk = 0, go_a = 0, go_b = 0;
    reg [6:0] address_a = 7'h50, address_b = 7'h50;
    reg [7:0] pointer_a = 0, pointer_b = 0;
    reg [3:0] count = 4;
    wire [63:0] data_a, data_b;
    wire [15:0] rounds_a, rounds_b, nacks_a, nacks_b, losses_a, losses_b;
    wire scl_a, sda_a, scl_b, sda_b, scl_s, sda_s;
    tri1 scl, sda;
    assign scl = dsp_scl ? 1'bz : 1'b0;
    assign sda = dsp_sda ? 1'bz : 1'b0;
    assign scl = other_scl ? 1'bz : 1'b0;
    assign sda = other_sda ? 1'bz : 1'b0;
    assign scl = scl_a & scl_b & scl_s ? 1'bz : 1'b0;
    assign sda = sda_a & sda_b & sda_s ? 1'bz : 1'b0;

    always begin
        wait (run);
        #(period_ps / 2000.0) clk = !clk;
    end

    i2c_master a(
        clk, quarter, zero_hold, scl, sda, scl_a, sda_a, go_a, address_a, pointer_a, count,
        data_a, rounds_a, nacks_a, losses_a);
    i2c_master b(
        clk, quarter, zero_hold, scl, sda, scl_b, sda_b, go_b, address_b, pointer_b, count,
        data_b, rounds_b, nacks_b, losses_b);
    i2c_slave s(clk, scl, sda, scl_s, sda_s);
endmodule

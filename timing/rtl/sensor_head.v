// The sensor head as logic, and the bus that it shares with the IMU emulator (dsp). Every PERIOD cycles of clk, it reads
// six bytes from each of gyroscope, accelerometer and magnetometer, GAP cycles apart, and outputs them for one cycle.
//
//     period --> gyroscope --GAP--> accelerometer --GAP--> magnetometer --> period
//                   '-- read: chip, data, refused --> test bench
`timescale 1ns / 1ps
module sensor_head #(
    parameter PERIOD = 20000,  // at 4 MHz: 5 ms
    parameter GAP = 240,
    parameter QUARTER = 10  // of a bit: 100 kHz
);
    reg clk = 0, dsp_scl = 1, dsp_sda = 1;
    tri1 scl, sda;
    wire head_scl, head_sda;
    assign scl = dsp_scl ? 1'bz : 1'b0;
    assign sda = dsp_sda ? 1'bz : 1'b0;
    assign scl = head_scl ? 1'bz : 1'b0;
    assign sda = head_sda ? 1'bz : 1'b0;

    always #125 clk = !clk;

    reg [1:0] chip = 0;  // 0, 1, 2: in the order of the round
    reg [15:0] rounds_before = 0, refused_before = 0;
    reg [31:0] ticks = 0, wait_until = PERIOD;
    reg go = 0, asked = 0, read = 0, refused = 0;
    wire [6:0] address = chip == 0 ? 7'h68 : chip == 1 ? 7'h53 : 7'h1E;
    wire [7:0] pointer = chip == 0 ? 8'h1D : chip == 1 ? 8'h32 : 8'h03;
    wire [63:0] data;
    wire [15:0] rounds, nacks, losses;
    reg [1:0] read_chip = 0;
    reg [47:0] read_data = 0;

    i2c_master master(
        clk, QUARTER[15:0], 1'b0, scl, sda, head_scl, head_sda, go, address, pointer, 4'd6,
        data, rounds, nacks, losses);

    always @(posedge clk) begin
        ticks <= ticks == PERIOD - 1 ? 0 : ticks + 1;
        go <= 0;
        read <= 0;
        if (!asked && (chip == 0 ? ticks == PERIOD - 1 : wait_until == 0)) begin
            go <= 1;
            asked <= 1;
            rounds_before <= rounds;
            refused_before <= nacks;
        end else if (asked && rounds != rounds_before) begin
            asked <= 0;
            read <= 1;
            read_chip <= chip;
            read_data <= data[47:0];
            refused <= nacks != refused_before;
            chip <= chip == 2 ? 0 : chip + 1;
            wait_until <= GAP;
        end else if (wait_until != 0) wait_until <= wait_until - 1;
    end
endmodule

// An I2C slave of 256 bytes with a pointer: a write sets the pointer and stores data, a read starts at the pointer.
// After each byte it holds SCL low for STRETCH cycles of clk. The initial value of byte n is 0x10 + n.
`timescale 1ns / 1ps
module i2c_slave #(
    parameter [6:0] ADDRESS = 7'h68,
    parameter STRETCH = 200
) (
    input clk,
    input scl,
    input sda,
    output reg scl_o,
    output reg sda_o
);
    localparam IDLE = 0, TAKE = 1, ACK = 2, GIVE = 3, HEAR = 4;

    reg [7:0] memory[0:255];
    reg [7:0] shift, pointer;
    reg [2:0] state;
    reg [3:0] bits;
    reg [15:0] hold;
    reg reading, first, pointed, scl_1, scl_2, scl_3, sda_1, sda_2, sda_3;
    integer n;

    initial begin
        for (n = 0; n < 256; n = n + 1) memory[n] = 8'h10 + n;
        scl_o = 1; sda_o = 1; state = IDLE; bits = 0; hold = 0; shift = 0; pointer = 0; reading = 0; first = 0;
        pointed = 0; scl_1 = 1; scl_2 = 1; scl_3 = 1; sda_1 = 1; sda_2 = 1; sda_3 = 1;
    end

    wire rise = scl_2 && !scl_3, fall = !scl_2 && scl_3;

    always @(posedge clk) begin
        {scl_3, scl_2, scl_1} <= {scl_2, scl_1, scl};
        {sda_3, sda_2, sda_1} <= {sda_2, sda_1, sda};
        if (hold != 0) begin
            hold <= hold - 1;
            if (hold == 1) scl_o <= 1;
        end
        if (scl_2 && scl_3 && sda_3 && !sda_2) begin  // START
            state <= TAKE;
            first <= 1;
            bits <= 0;
            sda_o <= 1;
        end else if (scl_2 && scl_3 && !sda_3 && sda_2) begin  // STOP
            state <= IDLE;
            sda_o <= 1;
        end else if (rise && state == TAKE) begin
            shift <= {shift[6:0], sda_2};
            bits <= bits + 1;
        end else if (rise && state == HEAR) begin
            if (sda_2) state <= IDLE;
        end else if (fall) case (state)
            TAKE: if (bits == 8) begin
                bits <= 0;
                if (first && shift[7:1] != ADDRESS) state <= IDLE;
                else begin
                    sda_o <= 0;
                    state <= ACK;
                    hold <= STRETCH;
                    scl_o <= STRETCH == 0;
                    first <= 0;
                    if (first) begin
                        reading <= shift[0];
                        pointed <= 0;
                    end else if (!pointed) begin
                        pointer <= shift;
                        pointed <= 1;
                    end else begin
                        memory[pointer] <= shift;
                        pointer <= pointer + 1;
                    end
                end
            end
            ACK: begin
                sda_o <= 1;
                state <= TAKE;
                if (reading) give;
            end
            GIVE: if (bits == 8) begin
                sda_o <= 1;
                state <= HEAR;
            end else begin
                sda_o <= shift[7];
                shift <= shift << 1;
                bits <= bits + 1;
            end
            HEAR: give;
            default: ;
        endcase
    end

    task give;
        begin
            sda_o <= memory[pointer][7];
            shift <= memory[pointer] << 1;
            pointer <= pointer + 1;
            bits <= 1;
            state <= GIVE;
        end
    endtask
endmodule

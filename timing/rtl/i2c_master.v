// An I2C master that writes a pointer and reads `count` bytes by repeated START, as often as `go` asks.
//
//     go --> S address W A pointer A Sr address R A data A ... data N P --> rounds + 1
//
// A bit has four quarters of `length` cycles of clk: SCL is low in two, then high in two. SDA changes at the begin of the
// first quarter (zero_hold) or of the second. If another party holds SCL low, the master waits. If the master sends a 1
// and reads a 0, it has lost arbitration, and begins again when the bus is free.
`timescale 1ns / 1ps
module i2c_master (
    input clk,
    input [15:0] length,
    input zero_hold,
    input scl,
    input sda,
    output reg scl_o,
    output reg sda_o,
    input go,
    input [6:0] address,
    input [7:0] pointer,
    input [3:0] count,
    output reg [63:0] data,
    output reg [15:0] rounds,
    output reg [15:0] nacks,
    output reg [15:0] losses
);
    localparam WAIT = 0, START = 1, SEND = 2, GET_ACK = 3, READ = 4, PUT_ACK = 5, STOP = 6;

    reg [2:0] state;
    reg [1:0] quarter;
    reg [15:0] ticks;
    reg [1:0] stage;  // byte that is sent: address W, pointer, address R
    reg [2:0] place;
    reg [7:0] shift;
    reg [3:0] left;
    reg bus_busy, scl_1, scl_2, sda_1, sda_2, sda_3, scl_3, bit_in, asked;

    initial begin
        scl_o = 1; sda_o = 1; state = WAIT; quarter = 0; ticks = 0; stage = 0; place = 0; shift = 0; left = 0;
        bus_busy = 0; scl_1 = 1; scl_2 = 1; sda_1 = 1; sda_2 = 1; sda_3 = 1; scl_3 = 1; bit_in = 1; asked = 0;
        data = 0; rounds = 0; nacks = 0; losses = 0;
    end

    wire sent = state == SEND ? shift[7] : state == PUT_ACK ? left == 1 : 1'b1;
    wire move_sda = quarter == (zero_hold ? 0 : 1) && ticks == 0;

    always @(posedge clk) begin
        {scl_3, scl_2, scl_1} <= {scl_2, scl_1, scl};
        {sda_3, sda_2, sda_1} <= {sda_2, sda_1, sda};
        if (scl_2 && scl_3 && sda_3 != sda_2) bus_busy <= !sda_2;  // START or STOP
        asked <= asked | go;
        if (state == WAIT) begin
            scl_o <= 1;
            sda_o <= 1;
            quarter <= 0;
            ticks <= bus_busy || !scl_2 || !sda_2 ? 0 : ticks + 1;  // bus-free time
            if (ticks >= 2 * length && asked) begin
                asked <= 0;
                stage <= 0;
                ticks <= 0;
                quarter <= 2;
                state <= START;
            end
        end else begin
            ticks <= ticks + 1;
            case (state)
                START: if (quarter == 3 && ticks == 0) sda_o <= 0; else if (quarter < 2 && move_sda) sda_o <= 1;
                STOP: if (quarter == 3 && ticks == 0) sda_o <= 1; else if (quarter < 2 && move_sda) sda_o <= 0;
                default: if (move_sda) sda_o <= sent;
            endcase
            if (quarter == 2 && ticks == 0) scl_o <= 1;
            if (quarter == 2 && !scl_2) ticks <= 1;  // stretched
            if (quarter == 3 && ticks == 0) begin
                bit_in <= sda_2;
                if (sent && !sda_2 && (state == SEND || state == PUT_ACK)) begin
                    losses <= losses + 1;
                    asked <= 1;
                    state <= WAIT;
                    ticks <= 0;
                    sda_o <= 1;
                end
            end else if (ticks == length - 1) begin
                ticks <= 0;
                quarter <= quarter + 1;
                if (quarter == 3) begin
                    if (state != STOP) scl_o <= 0;
                    next;
                end
            end
        end
    end

    task next;
        case (state)
            START: begin
                shift <= {address, stage == 2};
                place <= 7;
                state <= SEND;
            end
            SEND: begin
                shift <= shift << 1;
                place <= place - 1;
                if (place == 0) state <= GET_ACK;
            end
            GET_ACK: begin
                nacks <= nacks + bit_in;
                stage <= stage + 1;
                place <= 7;
                shift <= pointer;
                left <= count;
                state <= bit_in ? STOP : stage == 0 ? SEND : stage == 1 ? START : READ;
            end
            READ: begin
                shift <= {shift[6:0], bit_in};
                place <= place - 1;
                if (place == 0) begin
                    data <= {data[55:0], shift[6:0], bit_in};
                    state <= PUT_ACK;
                end
            end
            PUT_ACK: begin
                left <= left - 1;
                place <= 7;
                state <= left == 1 ? STOP : READ;
            end
            default: begin
                rounds <= rounds + 1;
                state <= WAIT;
            end
        endcase
    endtask
endmodule

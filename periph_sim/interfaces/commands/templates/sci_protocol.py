"""Answers text lines received over SCI-A: "V?" by the version, "S n" by "OK" and "S?" by the stored n, else "ERROR"."""

from periph_sim.firmware import start_sci

END = ord("\n")
PARSE = 600  # cycles to parse a command, counted or estimated


def main(dsp, settings):
    sci = start_sci(dsp, "SCI-A", brr=40)  # 114 329 baud
    stored = 0
    line = bytearray()
    while True:
        dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0)
        byte = sci.SCIRXBUF.RXDT
        if byte != END:
            line.append(byte)
            continue
        with dsp.span("command"):
            dsp.compute(PARSE)
            command, _, argument = line.decode("ascii", "replace").partition(" ")
            line.clear()
            if command == "V?":
                answer = "V 1.0"
            elif command == "S" and argument.isdecimal():
                stored = int(argument)
                # stored &= 0x1F  # remove the first "#": numbers above 31 are truncated, so budget "stored" breaks
                answer = "OK"
            elif command == "S?":
                answer = f"S {stored}"
            else:
                answer = "ERROR"
        send(dsp, sci, answer)


def send(dsp, sci, text):
    for byte in (*text.encode(), END):
        dsp.spin(lambda: sci.SCIFFTX.TXFFST < 16)
        sci.SCITXBUF.all = byte

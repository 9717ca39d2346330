"""Sensor parameters from recordings at rest: samples go in, bias and noise with their error bars come out.

    samples --> Allan deviation --> region of slope -1/2 --> noise density (N squared)
           \\-> mean, less what it should be --> bias, or hard iron
            \\-> flat part and slope +1/2, where asked for --> bias instability (B), random walk (K)

Method of the dissertation's section 4.3.4, after IEEE Std 952 annex C; error bars after NIST SP 1065.
"""

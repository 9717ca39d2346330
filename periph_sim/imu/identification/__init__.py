"""Identification of sensor parameters from recordings at rest: bias and noise with standard errors.

    samples --> Allan deviation --> region of slope -1/2 --> noise density (N squared)
           \\-> mean minus expected value --> bias, or hard iron
            \\-> flat part and slope +1/2, on request --> bias instability (B), random walk (K)

Method of the dissertation's section 4.3.4, after IEEE Std 952 annex C; error bars by NIST SP 1065.
"""

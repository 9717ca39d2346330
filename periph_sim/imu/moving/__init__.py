"""The moving experiment: the same motion measured by emulator and real chips, both with the same filter.

    case --emulator--> SCI, firmware, I2C --+
         --chips-----> ITG-3200 ... , I2C --+--> sensor head --> units, known biases off --> EKF --> attitudes
         --direct----> arrays, no wires ----+

Dissertation section 5.3 with Figures 5.4 to 5.6, and appendix B.
"""

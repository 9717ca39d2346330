"""The moving experiment: emulator and real chips measure the same motion, and the same filter estimates attitudes.

    case --emulator--> SCI, firmware, I2C --+
         --chips-----> ITG-3200 ... , I2C --+--> sensor head --> units --> minus known biases --> EKF --> attitudes
         --direct----> no wires ------------+

Dissertation section 5.3 with Figures 5.4 to 5.6, and appendix B.
"""

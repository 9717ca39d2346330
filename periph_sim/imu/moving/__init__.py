"""The moving experiment: a motion is measured by the emulator and by real chips, and both are filtered in the same way.

    case --emulator--> SCI, firmware, I2C --+
         --chips-----> ITG-3200 ... , I2C --+--> sensor head --> units, known biases off --> EKF --> attitudes
         --direct----> no wires ------------+

Dissertation section 5.3 with Figures 5.4 to 5.6, and appendix B.
"""

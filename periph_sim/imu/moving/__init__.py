"""The moving experiment: emulator and real sensors measure the same motion, and the same filter estimates attitudes.

    emulator:     host --SCI--> firmware --I2C--> sensor head -------+
    real sensors: ITG-3200, ADXL345, HMC5883L --I2C--> sensor head --+--> units, minus biases --> EKF --> attitudes

"Real sensors" are simulated chips that sense the true motion. The readings of the emulator and of the real sensors can
also be calculated without simulated wires. EKF is the extended Kalman filter of `attitude`.

Source: dissertation section 5.3 with Figures 5.4 to 5.6, and appendix B.
"""

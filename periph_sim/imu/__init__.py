"""Sensor models of an IMU: motion, arithmetic, noise, identification, extremes, and the dissertation's experiments.

Terms of this package:

the dissertation: the work in CITATION.cff, whose IMU emulator the models reproduce. Sections, equations, figures and
    tables are those of the dissertation if no other source is named.
host frame: the message of 12 bytes, with attitude and acceleration, that a host sends to the emulator.
case: the TOML file of a simulation. [host] and [controller] are tables of it.
phi, theta, psi: roll, pitch and yaw, the attitude angles. phi', theta', psi' are their derivatives.
p, q, r: the body rates, which are the rates of rotation about the axes x, y, z of the body.
Ts: the time between two samples of the models.
matrix S: the matrix with scale and cross-axis sensitivity that converts a quantity to LSB.
arithmetic: the kind of numbers in which the models calculate: float64, float32 or a Q format.
code: the whole number that a chip returns for a quantity, in LSB.
count: a value in a host frame, as a whole number, normally of 16 bits. For an angle, a count of 1 is normally 1e-4 rad.
emulator: firmware that calculates the codes of the chips from host frames.
chip: one of the three sensors, gyroscope ITG-3200, accelerometer ADXL345 and magnetometer HMC5883L.
sensor head: the I2C master that reads the chips, or the emulator in their place.
set: values for all parameters of the sensor models, such as `table_5_1`.
round: one execution of the requests that a controller repeats periodically.
truth: the motion of the body, without errors of sensors.
reference: the models in float64, with which the models in other kinds of arithmetic are compared.
as built: the gyroscope measures the derivatives of the attitude angles, as in the dissertation's section 4.3.2.
corrected: the gyroscope measures the body rates, as in the dissertation's appendix B.
"""

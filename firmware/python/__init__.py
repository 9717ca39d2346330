"""Reference firmware in Python. A case gives one of these files to a unit as its program, whose entry is `main`.

Terms of these programs:
dissertation: the one that CITATION.cff names. The case timing/imu_hil.toml is its test bench.
emulator: firmware that answers on I2C like three sensor chips: gyroscope, accelerometer and magnetometer.
sensor head: the I2C controller that reads these chips. A round is one reading of all of them.
host frame: twelve bytes that the host PC sends over SCI, from which the emulator computes the data of the chips.
span: a named part of the firmware, whose duration a budget can limit (`Dsp.span`).
"""

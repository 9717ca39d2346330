"""Mutants that are known to survive although they have an effect, each with a situation that would reveal it.

These are not arguments: the mutants count as survivors. A survivor that is not listed here fails the run.
"""

from __future__ import annotations

KNOWN = {
    "slave_config: exchanged: i2c.I2CMDR.MST = 0 --> i2c.I2CMDR.MST = 1": (
        "a write of STT, which no firmware here makes: without it a module with MST = 1 still answers its address"
    ),
    **dict.fromkeys(
        (
            "model: deleted: for chip, fixed in settings.table.items():",
            "model: moved past dsp.clear_pin(settings.pin): for chip, fixed in settings.table.items():",
            "model: moved past for chip, fixed in settings.table.items():: "
            "self.data[GYROSCOPE], self.data[ACCELEROMETER], self.data[MAGNETOMETER] = codes",
            "model: deleted: self.data[int(chip, 0)] = fixed",
            "model: 20 cycles late: self.data[int(chip, 0)] = fixed",
            "model: 300 cycles late: self.data[int(chip, 0)] = fixed",
            "model: exchanged: self.data[int(chip, 0)] = fixed --> self.data[int(chip, 1)] = fixed",
        ),
        "a case with fixed data, as `imu_hil_no_sdir`, which also breaks a budget with the unchanged firmware",
    ),
    **dict.fromkeys(
        (
            "model: moved past frame, self.frame_waits = (self.frame, False): dsp.set_pin(settings.pin)",
            "model: moved past frame, self.frame_waits = (self.frame, False): dsp.set_pin(self.settings.pin)",
        ),
        "a frame that ends within the few cycles of the access to the pin",
    ),
    "model: moved past dsp.compute(self.cost, 'model'): frame, self.frame_waits = (self.frame, False)": (
        "a frame that ends while the models run, as some do in the ten seconds of `imu_hil`"
    ),
    **dict.fromkeys(
        ("serve_frame_by_frame: 20 cycles late: self.model()", "serve_frame_by_frame: 300 cycles late: self.model()"),
        "a round other than the first before which no frame came",
    ),
    "wait_for_round: moved past self.look_at_round(): self.look_at_line()": (
        "a timer that expires, or a frame that ends, in the few cycles by which the timer is read earlier"
    ),
    "run: moved past self.start_timer(self.round_timer, settings.period - settings.guard): "
    "start_pie(dsp, {'SCIRXINTA': self.sci_received})": (
        "a frame that ends within the few cycles by which the round's timer starts earlier, 19.5 ms later"
    ),
    "run: moved past self.start_timer(self.wait_timer, settings.patience): "
    "self.start_timer(self.round_timer, settings.period - settings.guard)": (
        "a frame that ends within the few cycles by which the round's timer starts later, 19.5 ms later"
    ),
}

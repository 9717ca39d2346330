"""Bytes that a controller reads from the emulator's gyroscope, for every copy point, with and without the SDIR wait.

`python -m tests.scene.copy_points` prints the table that docs/slave_transmitter.md shows.
"""

from __future__ import annotations

from fractions import Fraction

from periph_sim import Case, Scene

DATA = "11 22 33 44 55 66"
POINTS = ("any_ack_fall9", "ack_fall9", "ack_rise9", "eager", "eager_if_trx", "eager_reloaded_at_address")
ROUNDS = 4


def read(point: str, *, wait: bool, pointer_by: str, others: dict[str, object] | None = None) -> list[str]:
    """Return the gyroscope's bytes in each of the first rounds, or "no answer" if its address was not acknowledged."""
    settings = {"model_cost": "250 us", "sdir_wait": wait, "table": dict.fromkeys(("0x68", "0x53", "0x1E"), DATA)}
    unit = {
        "firmware": "imu_hil",
        "modules": ["I2C-A"],
        "settings": settings,
        "options": {"i2c": {"dxr_to_xsr_copy_point": point, **(others or {})}},
    }
    head = {"order": ["gyroscope", "accelerometer", "magnetometer"], "pointer_by": pointer_by}
    case = {"name": point, "duration": "90 ms", "unit": {"dsp": unit}, "controller": head}
    scene = Scene(Case.model_validate(case))
    seen: list[str] = []

    def keep(transfer) -> None:
        for phase in transfer.phases:
            if transfer.name == "gyroscope" and phase.read:
                seen.append(phase.got.hex(" ") if phase.got else "no answer")

    scene.head.on_transfer.append(keep)
    scene.run(Fraction(90, 1000))
    return seen[:ROUNDS]


def shown(rounds: list[str]) -> str:
    """Return one cell of the table: the bytes of all rounds, or those of the first and those of the later rounds."""
    if not rounds:
        return "nothing"
    if len(set(rounds)) == 1:
        return rounds[0]
    if len(set(rounds[1:])) == 1:
        return f"{rounds[0]}, then {rounds[1]}"
    return "; ".join(rounds)


def table() -> str:
    heads = ("with the wait, repeated START", "without, repeated START", "with, STOP", "without, STOP")
    lines = [f"| `dxr_to_xsr_copy_point` | {' | '.join(heads)} |", "|---|---|---|---|---|"]
    for point in POINTS:
        cells = [
            shown(read(point, wait=wait, pointer_by=by)) for by in ("repeated START", "STOP") for wait in (True, False)
        ]
        lines.append(f"| `{point}` | {' | '.join(cells)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    print(table())

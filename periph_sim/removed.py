"""Names that users may still write and that were removed, each with the sentence that says what to use instead."""

from __future__ import annotations

COMMANDS = {
    "bound": (
        "`periph-sim bound` was removed: its formula missed dependences that are not visible in the firmware's source; "
        "`periph-sim prove`, planned, will cover every phase; until then `periph-sim sweep` runs many phases"
    ),
}
LEVELS = {
    "schedule": (
        "level 'schedule' was removed: its arithmetic knew one firmware only; `periph-sim prove`, planned, will make "
        "tables that replace it; until then `periph-sim sweep` runs many phases"
    ),
}
NAMES = {
    name: (
        f"periph_sim.{name} was removed: its arithmetic knew one firmware only; `periph-sim prove`, planned, will make "
        "tables that replace it; until then periph_sim.sweep runs many scenarios one by one"
    )
    for name in ("schedule", "BadSchedule", "ScheduleResult")
}

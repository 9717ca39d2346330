"""Check of the period of firmware's sensor models against the scene's."""

from __future__ import annotations

from ..scene.case.model import Case
from .models.parameters import ImuParameters
from .models.period import check_period
from .models.quantity import BadParameter


def check_sensor_period(case: Case, unit: str, settings: object, sensors: ImuParameters) -> None:
    """Raise BadCase unless the models' period is that at which this firmware runs them.

    That is the period of the rounds; or of the host, if `models_run` is "frame" or there are no rounds.
    """
    rounds = case.controller or case.rounds
    per_frame = getattr(settings, "models_run", "round") == "frame" or rounds is None
    table = case.host if per_frame else rounds
    if table is None:
        return
    what = (
        "once a host frame (host.period)"
        if per_frame
        else f"once a round ({'controller' if case.rounds is None else 'rounds'}.period)"
    )
    try:
        check_period(sensors, table.period, what)
    except BadParameter as error:
        raise case.mistake(error.what, "unit", unit, "settings", "parameters") from None

"""Checks the period of firmware's sensor models against the scene's: a case goes in, BadCase may come out."""

from __future__ import annotations

from ..sensors.models.parameters import ImuParameters
from ..sensors.models.period import check_period
from ..sensors.models.quantity import BadParameter
from .case.model import Case


def check_sensor_period(case: Case, unit: str, settings: object, sensors: ImuParameters) -> None:
    """BadCase unless the models' period is that at which this firmware runs them.

    That is the controller's, or the host's where the settings' `models_run` is "frame" or nobody asks in rounds.
    """
    per_frame = getattr(settings, "models_run", "round") == "frame" or case.controller is None
    table = case.host if per_frame else case.controller
    if table is None:
        return
    what = "once a host frame (host.period)" if per_frame else "once a round (controller.period)"
    try:
        check_period(sensors, table.period, what)
    except BadParameter as error:
        raise case.mistake(error.what, "unit", unit, "settings", "parameters") from None

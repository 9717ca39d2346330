"""Sines and cosines of an attitude (roll, pitch, yaw in rad), computed once for all three sensors."""

from __future__ import annotations

from typing import Generic, NamedTuple, TypeVar

from ..numeric.arithmetic import Arithmetic

T = TypeVar("T")


class Angles(NamedTuple, Generic[T]):
    """s: sine, c: cosine; of roll phi, pitch theta, yaw psi."""

    s_phi: T
    c_phi: T
    s_theta: T
    c_theta: T
    s_psi: T
    c_psi: T


def angles(a: Arithmetic[T], attitude: tuple[T, T, T]) -> Angles[T]:
    phi, theta, psi = attitude
    return Angles(*a.sincos(phi), *a.sincos(theta), *a.sincos(psi))

"""Sensors of the vehicle file: bounds of their errors, the rule that turns noise into bounds, and the limits of the vessel."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ivsid.errors import IvsidError
from ivsid.files.section import NonNegative, Positive, Probability, Section
from ivsid.vehicle.mount import Mounted


class VelocitySensor(Mounted):
    """A sensor of u and v.

    Attributes:
        accuracy: bound on the error of a reading [m/s].
        scale_factor_error: bound on |s|, for readings of (1 + s) times the truth.
        scale_factor_sign: the sign of s where it is known, else 0.
    """

    accuracy: NonNegative
    scale_factor_error: Annotated[float, Field(ge=0, lt=1)] = 0.0
    scale_factor_sign: Literal[-1, 0, 1] = 0


class InertialSensor(Section):
    """An accelerometer or a gyro; its unit is that of the quantity, m/s^2 or rad/s.

    Attributes:
        random_walk: noise coefficient N [unit sqrt(s)].
        rate_random_walk: noise coefficient K [unit/sqrt(s)].
        bias_instability: standard deviation B of a Gauss-Markov bias [unit], of both axes or of each.
        bias_time: its time constant T [s], of both axes or of each.
        accuracy: a bound beside the noise [unit].
        sampling: whether a reading is instantaneous or the mean over the sample before it.
    """

    random_walk: NonNegative = 0.0
    rate_random_walk: NonNegative = 0.0
    bias_instability: NonNegative | Annotated[tuple[NonNegative, NonNegative], Field()] = 0.0
    bias_time: Positive | tuple[Positive, Positive] = 300.0
    accuracy: NonNegative = 0.0
    sampling: Literal["instantaneous", "averaged"] = "instantaneous"

    def axis(self, index: int) -> tuple[float, float]:
        """Bias instability [unit] and bias time [s] of the axis ``index``, 0 for x and 1 for y."""
        b, t = self.bias_instability, self.bias_time
        return (b[index] if isinstance(b, tuple) else b), (t[index] if isinstance(t, tuple) else t)


class AccelerationSensor(InertialSensor, Mounted):
    """An accelerometer.

    Attributes:
        gravity: the columns ax and ay contain gravity, which the attitude removes: true, or its size [m/s^2].
        random_walk: noise coefficient N [m/s^2 sqrt(s)], of both axes or of each.
    """

    gravity: bool | Positive = False
    random_walk: NonNegative | tuple[NonNegative, NonNegative] = 0.0  # type: ignore[assignment]

    def walk(self, index: int) -> float:
        """Random walk [m/s^2 sqrt(s)] of the axis ``index``, 0 for x and 1 for y."""
        n = self.random_walk
        return n[index] if isinstance(n, tuple) else n


class AccuracySensor(Section):
    """A sensor with one bound on the error of its readings, in the unit of its quantity."""

    accuracy: NonNegative


class Limits(Section):
    """Bounds that the motion of the vessel never exceeds.

    Attributes:
        acceleration: bound on |udot| and |vdot| [m/s^2].
        yaw_acceleration: bound on |rdot| [rad/s^2].
        jerk: bound on the rates of udot and vdot [m/s^3]; there is none where a thrust jumps.
        yaw_jerk: bound on the rate of rdot [rad/s^3]; there is none where a thrust jumps.
    """

    acceleration: Positive | None = None
    yaw_acceleration: Positive | None = None
    jerk: Positive | None = None
    yaw_jerk: Positive | None = None


class Sensors(Section):
    """Sensor bounds, and the rule that turns noise into bounds: ``confidence`` or ``sigmas``, not both.

    Attributes:
        confidence: probability that all errors of the whole log stay inside their bounds; 0.999 where neither rule is stated.
        sigmas: bounds as a multiple of the standard deviation, the paper's rule.
        attitude: bounds roll and pitch [rad].
        limits: bounds on accelerations and their rates.
        from_pose: source of velocities that are not measured. ``enclosed`` bounds them from the pose under the stated limits.
            ``spline`` estimates them by a smoothing spline whose band is calibrated on its residuals and proves nothing.
    """

    confidence: Probability | None = None
    sigmas: Positive | None = None
    velocity: VelocitySensor | None = None
    acceleration: AccelerationSensor | None = None
    yaw_rate: InertialSensor | None = None
    yaw_acceleration: AccuracySensor | None = None
    heading: AccuracySensor | None = None
    attitude: AccuracySensor | None = None
    position: AccuracySensor | None = None
    wind: AccuracySensor | None = None
    force: AccuracySensor | None = None
    moment: AccuracySensor | None = None
    limits: Limits = Limits()
    from_pose: Literal["enclosed", "spline"] = "enclosed"

    @model_validator(mode="after")
    def _one_rule(self) -> Self:
        if self.confidence is not None and self.sigmas is not None:
            raise IvsidError("has both confidence and sigmas; give one")
        return self

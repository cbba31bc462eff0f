"""A log as the diagnosis reads it: every reading and every demand on one uniform clock.

A log comes with the clocks of its sensors, with gaps, and with sensors that stand anywhere on the hull. The chapter makes one value of it,
``Channels``, in four steps:

1. ``from_pose``: a log without velocities gets them as differences of its pose.
2. Readings are brought to the body origin (``ivsid.sensors.lever_arms``).
3. ``clock``: the step of the uniform clock is chosen; channels that come too rarely and single outliers (``outliers``) are left out.
4. ``resampling``: readings and demands are looked up on that clock, and samples without readings are marked;
   ``between`` holds the demands inside its steps, and where the readings of its samples were taken.

``one_run`` says whether two logs hold samples of one run, so that the second is no evidence of its own.
``sensor_noise`` estimates the white noise of each channel from its own scatter, and ``channels`` calls the steps in order.

Nothing is filled in beyond a single lost sample: the later stages count only the samples that are marked as good.
The chapter may use nothing else of the diagnosis.
"""

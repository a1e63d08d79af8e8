"""The same scene under the same sky in a path tracer (mitsuba 3): the reference of the GL frame."""

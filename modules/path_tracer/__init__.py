"""The same scene under the same sky in a path tracer (mitsuba 3): the judge of the GL frame."""

"""Small scenes of each kind of thing that files of others have, in frame and path tracer."""

"""Studies of clear skies: integration rules and sky models against truth and measurements."""

"""Where the sun stands and how much of its disc is up."""

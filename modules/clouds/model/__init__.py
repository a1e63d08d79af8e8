"""Light in and through layers of clouds, on the CPU."""

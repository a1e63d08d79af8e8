"""Benchmarks: what the host and its modules cost, beside what others cost in the same run."""

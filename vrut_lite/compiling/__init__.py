"""Compilation of kernels ahead of their use, in processes side by side, with its progress."""

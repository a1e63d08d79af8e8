"""The kernel: messages, modules, slots, and one transaction per input."""

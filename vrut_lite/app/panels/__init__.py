"""Panels: each sends inputs to the session and listens to its messages; none knows another."""

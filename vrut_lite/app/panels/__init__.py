"""Panels: each sends inputs and listens to messages of the session; none imports another."""

"""Northern and southern lights."""

"""The sky and sun of Hosek and Wilkie (2012, 2013)."""

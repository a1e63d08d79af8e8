"""The skies that are compared, each behind the one interface of `model`."""

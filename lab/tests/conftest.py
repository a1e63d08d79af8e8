"""Fixtures and options that the laboratory's tests share with the product's."""

pytest_plugins = ["house_fixtures"]

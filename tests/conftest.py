"""Fixtures and options that the product's tests share with the laboratory's."""

pytest_plugins = ["house_fixtures"]

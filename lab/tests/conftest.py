"""Fixtures and options that the laboratory's tests share with the product's."""

from open_sky import lit_by_the_open_sky  # noqa: F401

pytest_plugins = ["house_fixtures"]

"""DynamicSkyLight."""

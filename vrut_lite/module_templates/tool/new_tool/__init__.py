"""New tool: a log of the light on level ground, and its panel."""

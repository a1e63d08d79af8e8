"""One HTML file in which a browser shows a scene's daylight at any hour: `vrut-lite share`."""

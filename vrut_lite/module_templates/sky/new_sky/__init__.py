"""New sky: the overcast sky of Moon and Spencer."""

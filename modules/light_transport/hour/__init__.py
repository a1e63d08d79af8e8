"""The light of an hour, from the counts of rays.

In reading order: `hour` has inputs and results, `key_light` lights patches, `exchange` bounces
light between them, `gather` brings it to texels, `smoothing` and `filling` finish the map.
"""

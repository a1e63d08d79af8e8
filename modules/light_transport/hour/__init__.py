"""The light of an hour, from the counts of rays.

In reading order: `illumination` has inputs and results, `relighting` the steps of an hour:
`key_light` lights patches, `patch_transfer` bounces light between them, `gather` brings it to
texels, `smoothing` and `borders` finish the map.
"""

"""A photograph of the sky as the sky: a panorama, its sun taken out and put back as a light."""

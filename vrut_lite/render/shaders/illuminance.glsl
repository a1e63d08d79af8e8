// Irradiance of the visible surface without normal maps, as a light meter on it measures.

vec3 irradiance_of(vec3 face, vec3 n, bool behind) {
#ifdef IRRADIANCE
    vec3 found = surface_light(face, n, n, behind, 1.0).light.rgb;
#elif defined(MAP_VALUES)
    vec3 found = vec3(0.0);  // no map, no value
#else
    vec3 found = sky_irradiance(n);
#endif
    float nl = dot(n, sun_direction);
#ifndef NO_SKY
    if (nl > 0.0 && dot(face, sun_direction) > 0.0) {
        vec3 sun = sun_irradiance * (nl * sun_visibility(face));
#ifdef GLASS_SHADOW
        sun *= sun_through_glass(face);
#endif
#ifdef SUN_FACTOR
        sun *= sun_factor(eye_to_sample);
#endif
        found += sun;
    }
#endif
#ifdef EXTRA_LIGHTS
    for (int number = 0; number < extra_light_count(); ++number) {
        vec3 towards, extra = extra_light(number, point_in_triangle(face), face, towards);
        found += extra * max(dot(n, towards), 0.0);
    }
#endif
    return found;
}

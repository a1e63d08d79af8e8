// A thin film on a surface, KHR_materials_iridescence: geometry/thin_film.py makes its table.
layout(binding = 33) uniform sampler3D film_table;
#ifdef HAS_IRIDESCENCE_TEX
layout(binding = 27) uniform sampler2D iridescence_map;
#endif
#ifdef HAS_IRIDESCENCE_THICKNESS_TEX
layout(binding = 28) uniform sampler2D iridescence_thickness_map;
#endif

// Schlick's f0 of a surface under its film, seen at a cosine; its f90 stays.
vec3 under_film(vec3 f0, float nv) {
    float share = terms.iridescence, thickness = 1.0;
#ifdef TEXCOORD_0_LOC
#ifdef HAS_IRIDESCENCE_TEX
    share *= texture(iridescence_map, uv_of(int(terms.iridescence_layer))).r;
#endif
#ifdef HAS_IRIDESCENCE_THICKNESS_TEX
    thickness = texture(iridescence_thickness_map, uv_of(int(terms.iridescence_thickness_layer))).g;
#endif
#endif
    vec3 size = vec3(textureSize(film_table, 0)), filmed;
    for (int channel = 0; channel < 3; ++channel) {
        vec3 at = vec3(nv, sqrt(clamp(f0[channel], 0.0, 1.0)), thickness) * (size - 1.0) + 0.5;
        filmed[channel] = textureLod(film_table, at / size, 0.0)[channel];
    }
    return mix(f0, filmed, share);
}

// Terms of glTF's material extensions; render/surface_terms.py uploads them and sets the defines.
//!include surface_terms_block.glsl

#ifdef HAS_SPECULAR_TEX
layout(binding = 18) uniform sampler2D specular_map;
#endif
#ifdef HAS_SPECULAR_COLOUR_TEX
layout(binding = 19) uniform sampler2D specular_colour_map;
#endif
#ifdef HAS_CLEARCOAT_TEX
layout(binding = 20) uniform sampler2D clearcoat_map;
#endif
#ifdef HAS_TRANSMISSION_TEX
layout(binding = 21) uniform sampler2D transmission_map;
#endif

// Terms times their maps' texels: reflectance of dielectrics at normal incidence and at grazing
// angles, clearcoat factor, and transmission.
void look_up_terms(out vec3 f0, out float f90, out float clearcoat, out float transmission) {
    f0 = terms.f0;
    f90 = terms.f90;
    clearcoat = terms.clearcoat;
    transmission = terms.transmission;
#ifdef TEXCOORD_0_LOC
#ifdef HAS_SPECULAR_COLOUR_TEX
    f0 *= texture(specular_colour_map, uv_of(int(terms.specular_colour_layer))).rgb;
#endif
#ifdef HAS_SPECULAR_TEX
    float specular = texture(specular_map, uv_of(int(terms.specular_layer))).a;
    f0 *= specular;
    f90 *= specular;
#endif
#ifdef HAS_CLEARCOAT_TEX
    clearcoat *= texture(clearcoat_map, uv_of(int(terms.clearcoat_layer))).r;
#endif
#ifdef HAS_TRANSMISSION_TEX
    transmission *= texture(transmission_map, uv_of(int(terms.transmission_layer))).r;
#endif
#endif
}

float peak(vec3 v) {
    return max(v.r, max(v.g, v.b));
}

#ifdef IRIDESCENCE
//!include thin_film.glsl
#endif

#ifdef SHEEN
// Charlie's distribution of fibres (Estevez and Kulla 2017) with Neubelt's visibility:
// KHR_materials_sheen.
vec3 sheen_brdf(float nl, float nv, float nh) {
    float inverse = 1.0 / max(terms.sheen_roughness * terms.sheen_roughness, 1e-3);
    float distribution = (2.0 + inverse) * pow(max(1.0 - nh * nh, 0.0), 0.5 * inverse) / (2.0 * PI);
    return terms.sheen_rgb * (distribution / (4.0 * (nl + nv - nl * nv)));
}
#endif

#ifdef SHEEN
// Share of a uniform sky that white fibres reflect: the table's fourth channel.
float sheen_share(float mu) {
    float last = float(textureSize(reflectance, 0).x - 1);
    vec2 at = vec2(sqrt(clamp(mu, 0.0, 1.0)), terms.sheen_roughness) * last + 0.5;
    return texture(reflectance, at / (last + 1.0)).a;
}
#endif

#ifdef CLEARCOAT
float clearcoat_share(float mu) {
    return coat(shares(mu, terms.clearcoat_roughness).xy, TABLE_F0, 1.0);
}

// Transmittance of the clearcoat for light from one direction, relative to that of uniform light.
float below_clearcoat(float clearcoat, float nl) {
    float mean = shares(1.0, terms.clearcoat_roughness).z;
    return (1.0 - clearcoat * clearcoat_share(max(nl, 0.0))) / (1.0 - clearcoat * mean);
}

// Clearcoat reflection of light from one direction; `light` falls on a plane that faces it.
vec3 clearcoat_highlight(vec3 light, vec3 towards, float clearcoat, vec3 n, vec3 view) {
    float nv = max(dot(n, view), 1e-4), nl = dot(n, towards);
    if (nl <= 0.0) return vec3(0.0);
    vec2 share = shares(nv, terms.clearcoat_roughness).xy;
    vec3 h = normalize(towards + view);
    float nh = clamp(dot(n, h), 0.0, 1.0), vh = clamp(dot(view, h), 0.0, 1.0);
    float alpha = max(terms.clearcoat_roughness * terms.clearcoat_roughness, SMALLEST_ALPHA);
    float more = 1.0 + TABLE_F0 * (1.0 / (share.x + share.y) - 1.0);
    vec3 lobe = specular_brdf(nl, nv, nh, vh, alpha, vec3(TABLE_F0), vec3(1.0));
    return light * (clearcoat * more * nl) * lobe;
}

// Radiance of a surface under a clearcoat, which transmits the unreflected rest:
// KHR_materials_clearcoat, coupled as paint and coat are. `sky_seen` is the mean over the coat's
// lobe.
vec3 under_clearcoat(vec3 below, float clearcoat, vec3 n, vec3 view, vec3 highlights,
                     vec3 sky_seen) {
    float nv = max(dot(n, view), 1e-4);
    float reflected = coat(shares(nv, terms.clearcoat_roughness).xy, TABLE_F0, 1.0);
    return below * (1.0 - clearcoat * reflected) + clearcoat * reflected * sky_seen + highlights;
}
#endif

#ifdef ANISOTROPY
// Directions of the steepest facet slopes, and across (unit vectors perpendicular to n).
void anisotropy_axes(vec3 n, out vec3 along, out vec3 across) {
    along = vec3(1.0, 0.0, 0.0);
#ifdef TEXCOORD_0_LOC
    vec3 dpx = dFdx(eye_to_point), dpy = dFdy(eye_to_point);
    vec2 dux = dFdx(first_uv), duy = dFdy(first_uv);
    along = cross(dpy, n) * dux.x + cross(n, dpx) * duy.x;
#endif
    along -= n * dot(n, along);
    if (!(dot(along, along) > 0.0)) along = abs(n.y) < 0.9 ? cross(n, vec3(0, 1, 0)) : cross(n, vec3(1, 0, 0));
    along = normalize(along);
    // Texture coordinates run downwards in the file, upwards here.
    across = cross(n, along);
    float c = cos(terms.anisotropy_rad), s = sin(terms.anisotropy_rad);
    vec3 turned = along * c + across * s;
    across = across * c - along * s;
    along = turned;
}

// GGX with two widths: KHR_materials_anisotropy.
vec3 stretched_brdf(vec3 n, vec3 l, vec3 v, vec3 h, float nl, float nv, float vh, float alpha,
                    vec3 f0, vec3 f90) {
    vec3 along, across;
    anisotropy_axes(n, along, across);
    float strength = terms.anisotropy * terms.anisotropy;
    float at = mix(alpha, 1.0, strength), ab = alpha;
    vec3 slope = vec3(dot(along, h) / at, dot(across, h) / ab, dot(n, h));
    float spread = dot(slope, slope);
    float distribution = 1.0 / (PI * at * ab * spread * spread);
    float visibility = 0.5 / (nl * length(vec3(at * dot(along, v), ab * dot(across, v), nv))
                              + nv * length(vec3(at * dot(along, l), ab * dot(across, l), nl)));
    return distribution * visibility * (f0 + (f90 - f0) * pow(1.0 - vh, 5.0));
}

// Normal about which an anisotropic highlight mirrors the sky.
vec3 bent_normal(vec3 n, vec3 v, float roughness) {
    vec3 along, across;
    anisotropy_axes(n, along, across);
    vec3 bent = cross(cross(across, v), across);
    float bend = 1.0 - terms.anisotropy * (1.0 - roughness);
    bend *= bend;
    return normalize(mix(normalize(bent), n, bend * bend));
}
#endif

#ifdef BACKDROP
layout(binding = 22) uniform sampler2D backdrop;  // mipmapped copy of the framebuffer
uniform mat4 clip_from_eye;

// Background refracted by a body or blurred by its roughness, before the tint.
vec3 seen_through(vec3 point, vec3 n, vec3 view, float roughness) {
    vec3 d = -view;
    if (terms.thickness_m > 0.0) {
        d = refract(-view, n, 1.0 / max(terms.ior, 1.0 + 1e-6));
        d *= terms.thickness_m;
    }
    vec4 clip = clip_from_eye * vec4(point + (terms.thickness_m > 0.0 ? d : vec3(0.0)), 1.0);
    vec2 at = clamp(0.5 + 0.5 * clip.xy / clip.w, 0.0, 1.0);
    // Facets tilt by alpha (GGX's median) and deflect light by twice as much; the eye sees half of
    // that angle at most where objects are nearer behind the surface than the eye is in front. A
    // body of ior 1 does not blur, however rough it is.
    float spread_rad = roughness * roughness * clamp(2.0 * terms.ior - 2.0, 0.0, 1.0);
    float focal = length(vec3(clip_from_eye[0][1], clip_from_eye[1][1], clip_from_eye[2][1]));
    float pixel_rad = 2.0 / (focal * float(textureSize(backdrop, 0).y));
    float level = log2(max(spread_rad / pixel_rad, 1.0));
    vec3 behind = textureLod(backdrop, at, level).rgb;
    return behind * exp(-terms.extinction_per_m * length(d) * (terms.thickness_m > 0.0 ? 1.0 : 0.0));
}
#endif

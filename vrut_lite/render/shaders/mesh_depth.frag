#version 430 core
// Depth of shadow casters, without cut-out texels and glass. With TINT, transmittance of glass and
// blended surfaces, to be multiplied, and their depth.

uniform float base_alpha;
uniform float alpha_cutoff;
uniform float has_alpha_texture;
uniform sampler2D alpha_texture;

#ifdef TEXCOORD_0_LOC
in vec2 uv;
#endif

#ifdef CUT_OUT
//!include cut_out.glsl
#endif

#ifdef TINT
uniform float blended;     // 1: alpha is the surface's coverage
uniform float map_aspect;  // of the shadow map, its width over its depth
out vec4 left;
#ifdef GLASS
//!include surface_terms_block.glsl
uniform vec3 base_tint;
uniform float map_texels;  // along a side of the shadow map

vec3 left_by_glass(vec3 texel) {
    vec2 slope = map_texels / map_aspect * vec2(dFdx(gl_FragCoord.z), dFdy(gl_FragCoord.z));
    float nl = inversesqrt(1.0 + dot(slope, slope));
    float f0 = max(terms.f0.r, max(terms.f0.g, terms.f0.b));
    float through = 1.0 - mix(f0, terms.f90, pow(1.0 - nl, 5.0));
    vec3 tint = base_tint * texel;
    // Each side of a body contributes half of the tint.
    if (terms.thickness_m > 0.0) tint = sqrt(tint * exp(-terms.extinction_per_m * terms.thickness_m));
    return tint * (through * terms.transmission);
}
#endif
#endif

#ifdef HAS_TRANSMISSION_TEX
layout(binding = 21) uniform sampler2D transmission_map;
#endif

void main() {
    float alpha = base_alpha;
#if defined(HAS_TRANSMISSION_TEX) && defined(TEXCOORD_0_LOC)
    bool is_glass = texture(transmission_map, uv).r >= 0.5;
#ifdef TINT
    if (!is_glass) discard;
#else
    if (is_glass) discard;
#endif
#endif
#ifdef TINT
    vec4 texel = vec4(1.0);
#ifdef TEXCOORD_0_LOC
    if (has_alpha_texture > 0.5) texel = texture(alpha_texture, uv);
#endif
    vec3 tint = vec3(0.0);
#ifdef GLASS
    tint = left_by_glass(texel.rgb);
#endif
    // Depth within a range as deep as the map is wide, which half floats resolve.
    float depth = clamp((gl_FragCoord.z - 0.5) / map_aspect + 0.5, 0.0, 1.0);
    left = vec4(mix(vec3(1.0), tint, mix(1.0, base_alpha * texel.a, blended)), depth);
    return;
#endif
#if defined(CUT_OUT) && defined(TEXCOORD_0_LOC)
    float share = covered_share(alpha_texture, uv, texture(alpha_texture, uv).a);
    if (share <= shadow_threshold()) discard;
    return;
#endif
#ifdef TEXCOORD_0_LOC
    if (has_alpha_texture > 0.5) alpha *= texture(alpha_texture, uv).a;
#endif
    if (alpha < alpha_cutoff) discard;
}

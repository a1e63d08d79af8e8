#version 430 core
// A cut-out leaf casts the shadow of the leaf, not of its quad.

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

void main() {
    float alpha = base_alpha;
#if defined(CUT_OUT) && defined(TEXCOORD_0_LOC)
    float share = covered_share(alpha_texture, uv, texture(alpha_texture, uv).a);
    if (share <= threshold()) discard;
    return;
#endif
#ifdef TEXCOORD_0_LOC
    if (has_alpha_texture > 0.5) alpha *= texture(alpha_texture, uv).a;
#endif
    if (alpha < alpha_cutoff) discard;
}

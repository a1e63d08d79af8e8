#version 430 core
// One face of one level of the filtered sky: its mean over the lobe of a roughness, the twin of
// render/reflection.py's `prefiltered`.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f, binding = 0) writeonly uniform imageCube filtered;
uniform samplerCube sky;
uniform int face;
uniform float alpha;
uniform int samples;

const float PI = 3.141592653589793;
const mat2 GOLDEN_TURN = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);

//!include cube_texel.glsl

void main() {
    int size = imageSize(filtered).x;
    ivec3 at = ivec3(gl_GlobalInvocationID.xy, face);
    if (at.x >= size || at.y >= size) return;
    vec3 n = texel_direction(at, size);
    vec3 across = normalize(cross(abs(n.y) < 0.9 ? vec3(0, 1, 0) : vec3(1, 0, 0), n));
    vec3 along = cross(n, across);
    float a2 = alpha * alpha;
    // Facets, in equal shares of D(h) (n.h), along a golden spiral, as far as their mirror image
    // of the view stays before the surface: (n.h)^2 > 1/2.
    float share = 1.0 / (float(samples) * (1.0 + a2));
    float texel_sr = 4.0 * PI / (6.0 * pow(float(textureSize(sky, 0).x), 2.0));
    vec3 sum = vec3(0.0);
    float weight = 0.0;
    vec2 turned = vec2(1.0, 0.0);
    for (int i = 0; i < samples; ++i) {
        float u = (float(i) + 0.5) * share;
        float nh2 = (1.0 - u) / (1.0 + (a2 - 1.0) * u);
        float nl = 2.0 * nh2 - 1.0;
        float across_length = 2.0 * sqrt(max(0.0, nh2 * (1.0 - nh2)));
        vec3 l = across_length * (turned.x * across + turned.y * along) + nl * n;
        turned = GOLDEN_TURN * turned;
        // Each sample stands for the solid angle share / pdf, with pdf = D(h) / 4: it is looked
        // up in the mip level whose texels are as large (Krivanek and Colbert 2008).
        float d = nh2 * (a2 - 1.0) + 1.0;
        float sample_sr = share * 4.0 * PI * d * d / a2;
        float level = 0.5 * log2(sample_sr / texel_sr);
        sum += nl * textureLod(sky, l, level).rgb;
        weight += nl;
    }
    imageStore(filtered, at, vec4(sum / weight, 1.0));
}

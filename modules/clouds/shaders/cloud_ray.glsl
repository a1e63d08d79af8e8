// A ray of the clouds' picture: its part in the layer, and meshes in front of that.

//!include cloud_pieces.glsl

layout(binding = 4) uniform sampler2D mesh_depth;
uniform float near_m;
uniform int mesh_pixels;
uniform vec3 view_axis;

in vec3 ray;
layout(location = 0) out vec4 before_sky;
layout(location = 1) out vec4 before_mesh;
// x: mean distance of visible cloud, 0 without cloud, -1 minus it where the march ended at a mesh.
// y: distance of the first cloud, NEVER without one, 0 where the ray was not marched.
layout(location = 2) out vec2 cloud_distances_m;

// Pictures of one sample give the sky a depth, 0 is that of others: cloud_pass.py.
const float SKY_DEPTH = 1e-20;

// Whether no pixel of the frame that takes this one in shows the sky.
bool sky_is_hidden() {
    ivec2 first = (ivec2(gl_FragCoord.xy) - 1) * mesh_pixels;
    vec2 texel = 1.0 / vec2(textureSize(mesh_depth, 0));
    float farthest = 1.0;
    for (int i = 0; i < (mesh_pixels + 1) * (mesh_pixels + 1); ++i) {
        ivec2 square = 2 * ivec2(i % (mesh_pixels + 1), i / (mesh_pixels + 1));
        vec4 four = textureGather(mesh_depth, vec2(first + square + 1) * texel);
        farthest = min(farthest, min(min(four.x, four.y), min(four.z, four.w)));
    }
    return farthest > SKY_DEPTH;
}

struct LayerRay {
    vec3 d;
    float along;
    vec4 pieces;      // that are seen
    float mesh_m;     // NEVER where the pixel shows the sky
    bool sky_hidden;
};

LayerRay layer_ray() {
    vec3 d = normalize(ray);
    float along = clouds.eye_radius_m * d.y, perigee_m = clouds.eye_radius_m * length(d.xz);
    float mesh_m = NEVER;
    float depth = texelFetch(mesh_depth, ivec2(gl_FragCoord.xy * float(mesh_pixels)), 0).r;
    if (depth > SKY_DEPTH) mesh_m = near_m / depth / dot(d, view_axis);
    bool hidden = mesh_m < NEVER && sky_is_hidden();
    vec4 piece = pieces(along, perigee_m, last_distance(along, perigee_m));
    if (hidden) piece.yw = min(piece.yw, mesh_m);
    return LayerRay(d, along, piece, mesh_m, hidden);
}

// A ray of the clouds' picture: its part in the layer, and meshes in front of that.

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

const float NEVER = 1e30;
// Pictures of one sample give the sky a depth, 0 is that of others: cloud_pass.py.
const float SKY_DEPTH = 1e-20;

// Distances to where the ray enters and leaves a sphere, and half the chord; none if negative.
vec3 chord(float along, float perigee_m, float squares_m2) {
    float radius = sqrt(clouds.eye_radius_m * clouds.eye_radius_m + squares_m2);
    // Two equal forms of one square; this one has less cancellation.
    float squared = squares_m2 < 0.0 && perigee_m < 0.7 * radius
        ? (radius - perigee_m) * (radius + perigee_m) : along * along + squares_m2;
    if (squared <= 0.0) return vec3(NEVER, -NEVER, -1.0);
    float root = sqrt(squared);
    float far = along > 0.0 ? along + root : root - along;
    return along > 0.0 ? vec3(-far, squares_m2 / far, root)
                       : vec3(-squares_m2 / far, far, root);
}

float last_distance(float along, float perigee_m) {
    vec3 ground = chord(along, perigee_m, clouds.ground_squares_m2);
    return ground.z > 0.0 && along < 0.0 ? ground.x : NEVER;
}

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

// The one or two pieces of a ray that lie in the layer: (from, to) each, in m from the eye.
vec4 pieces(float along, float perigee_m, float last_m) {
    vec3 top = chord(along, perigee_m, clouds.top_squares_m2);
    vec3 base = chord(along, perigee_m, clouds.base_squares_m2);
    float first_m = max(top.x, 0.0), end_m = min(top.y, last_m);
    if (base.z < 0.0) return vec4(first_m, end_m, NEVER, -NEVER);
    return vec4(first_m, min(end_m, base.x), max(first_m, base.y), end_m);
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

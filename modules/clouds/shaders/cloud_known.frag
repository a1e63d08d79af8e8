#version 430 core
// Pixels of the clouds' picture that need no march. The march skips what this writes, by its depth:
// a branch would not do, of a renderer that runs both.

//!include cloud_block.glsl
//!include cloud_ray.glsl
#ifdef TAKE_OVER
//!include cloud_take_over.glsl
#endif

void main() {
    LayerRay seen = layer_ray();
    bool empty = seen.pieces.x >= seen.pieces.y && seen.pieces.z >= seen.pieces.w;
#ifdef TAKE_OVER
    if (!empty && taken_over(seen)) return;
#endif
    if (!empty) discard;
    before_sky = before_mesh = vec4(0.0, 0.0, 0.0, 1.0);
    cloud_distances_m = seen.sky_hidden ? vec2(-1.0, 0.0) : vec2(0.0, NEVER);
}

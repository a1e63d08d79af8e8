#version 430 core
// Nearest and farthest depth in the cells of a shadow map. FIRST: cells of 8 x 8 texels. CORNERS:
// the four cells around each corner, so that a place's nearest corner covers half a cell all around
// it. Otherwise: cells twice as wide. Every gather is in the middle of four texels.

uniform sampler2D source;

in vec2 at;
out vec2 range;

float least(vec4 four) {
    return min(min(four.x, four.y), min(four.z, four.w));
}

float greatest(vec4 four) {
    return max(max(four.x, four.y), max(four.z, four.w));
}

void main() {
    vec2 size = vec2(textureSize(source, 0));
#ifdef FIRST
    vec2 first = 8.0 * floor(at * size / 8.0);
    vec4 nearest = vec4(1.0), farthest = vec4(0.0);
    for (int j = 1; j < 8; j += 2) {
        for (int i = 1; i < 8; i += 2) {
            vec4 four = textureGather(source, (first + vec2(i, j)) / size);
            nearest = min(nearest, four);
            farthest = max(farthest, four);
        }
    }
    range = vec2(least(nearest), greatest(farthest));
#else
#ifdef CORNERS
    vec2 middle = floor(at * size) / size;
#else
    vec2 middle = (2.0 * floor(at * size / 2.0) + 1.0) / size;
#endif
    range = vec2(least(textureGather(source, middle, 0)), greatest(textureGather(source, middle, 1)));
#endif
}

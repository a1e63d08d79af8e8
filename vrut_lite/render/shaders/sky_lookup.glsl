// The cube map is sampled no nearer to the horizon than its first row on either side (1 above,
// -1 below): linear filtering across it would mix sky and ground into a grey band.
vec3 sky_on_side(samplerCube sky, vec3 d, float side) {
    float widest = max(abs(d.x), abs(d.z));
    float row = widest / float(textureSize(sky, 0).x);
    vec3 kept = vec3(d.x, side > 0.0 ? max(d.y, row) : min(d.y, -row), d.z);
    return textureLod(sky, kept, 0.0).rgb;
}

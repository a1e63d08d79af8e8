//!include cut_out.glsl

// A threshold by the pixel, even over 4 x 4 of them (Bayer), and over the pictures of one.
float threshold() {
    ivec2 at = ivec2(gl_FragCoord.xy) & 3, half_at = at >> 1;
    at &= 1;
    int fine = 2 * (at.x ^ at.y) + at.y, coarse = 2 * (half_at.x ^ half_at.y) + half_at.y;
    int turn = 16 * picture_number / picture_count;
    int step = (4 * fine + coarse + turn + number_of_triangle()) & 15;
    return (float(step) + (float(picture_number) + 0.5) / float(picture_count)) / 16.0;
}

// Leave out of the pixel's samples what is cut away.
void cover(float alpha) {
    float share = covered_share(material.base_color_texture, uv_of(base_color_layer), alpha);
    int samples = int(float(gl_NumSamples) * share + threshold());
    if (samples == 0) discard;
    // Another one first in each pixel.
    int first = (int(gl_FragCoord.x) + 2 * int(gl_FragCoord.y)) % gl_NumSamples;
    int mask = (1 << samples) - 1;
    gl_SampleMask[0] = (mask << first) | (mask >> (gl_NumSamples - first));
}

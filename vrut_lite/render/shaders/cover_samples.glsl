//!include cut_out.glsl

// Threshold of a pixel, uniform over 4 x 4 pixels (Bayer) and over the pictures of a still.
float threshold() {
    ivec2 at = ivec2(gl_FragCoord.xy) & 3, half_at = at >> 1;
    at &= 1;
    int fine = 2 * (at.x ^ at.y) + at.y, coarse = 2 * (half_at.x ^ half_at.y) + half_at.y;
    int turn = 16 * picture_number / picture_count;
    int step = (4 * fine + coarse + turn + number_of_triangle()) & 15;
    return (float(step) + (float(picture_number) + 0.5) / float(picture_count)) / 16.0;
}

// Mask the pixel's samples that a cut-out map does not cover.
void cover(float alpha) {
    float share = covered_share(material.base_color_texture, uv_of(base_color_layer), alpha);
    int samples = int(float(gl_NumSamples) * share + threshold());
    if (samples == 0) discard;
    // The first sample differs between pixels.
    int first = (int(gl_FragCoord.x) + 2 * int(gl_FragCoord.y)) % gl_NumSamples;
    int mask = (1 << samples) - 1;
    gl_SampleMask[0] = (mask << first) | (mask >> (gl_NumSamples - first));
}

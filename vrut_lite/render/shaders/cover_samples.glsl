//!include cut_out.glsl

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

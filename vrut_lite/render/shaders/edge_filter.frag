#version 430 core
// Blends across edges where one sample a pixel leaves steps (Lottes 2009, "FXAA", the short form):
// the picture is averaged along the edge, as far as its contrast stays within the neighbours'.

uniform sampler2D picture;  // as displayed; alpha is its luma

out vec4 display;

const float LONGEST = 8.0;         // pixels along an edge
const float LEAST_CONTRAST = 0.03;

in vec2 at;

void main() {
    vec2 pixel = 1.0 / vec2(textureSize(picture, 0));
    vec4 middle = textureLod(picture, at, 0.0);
    float nw = textureLod(picture, at + vec2(-0.5, 0.5) * pixel, 0.0).a;
    float ne = textureLod(picture, at + vec2(0.5, 0.5) * pixel, 0.0).a;
    float sw = textureLod(picture, at + vec2(-0.5, -0.5) * pixel, 0.0).a;
    float se = textureLod(picture, at + vec2(0.5, -0.5) * pixel, 0.0).a;
    float darkest = min(middle.a, min(min(nw, ne), min(sw, se)));
    float brightest = max(middle.a, max(max(nw, ne), max(sw, se)));
    vec2 along = vec2((nw + ne) - (sw + se), (nw + sw) - (ne + se));
    float least = max((nw + ne + sw + se) * 0.03, 1.0 / 128.0);
    along = clamp(along / (min(abs(along.x), abs(along.y)) + least), -LONGEST, LONGEST) * pixel;
    vec4 near = 0.5 * (textureLod(picture, at - along / 6.0, 0.0)
                       + textureLod(picture, at + along / 6.0, 0.0));
    vec4 far = 0.5 * near + 0.25 * (textureLod(picture, at - along * 0.5, 0.0)
                                    + textureLod(picture, at + along * 0.5, 0.0));
    vec4 found = far.a < darkest || far.a > brightest ? near : far;
    display = vec4(brightest - darkest < LEAST_CONTRAST ? middle.rgb : found.rgb, 1.0);
}
